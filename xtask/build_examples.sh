#!/usr/bin/env bash
# Tests, builds in and renders the plugins of plugins/examples, each copied out of the repository first: as a stranger's
# crates. Needs the program: SPECTRA names it, or it is built. The profile is this workspace's dev, so that what its tests were
# built from is not built again.
set -euo pipefail
root=$(cd "$(dirname "$0")/.." && pwd)
target=${CARGO_TARGET_DIR:-$root/target}
program=${SPECTRA:-$target/debug/spectra}
[ -x "$program" ] || (cd "$root" && cargo build --locked)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
export CARGO_TARGET_DIR=$target
with=()
# The sections of a manifest that say how to compile.
profiles() { awk '/^\[/ { kept = /^\[profile\./ } kept && !/^#/' "$1"; }
others() { awk '/^\[/ { kept = !/^\[profile\./ } kept' "$1"; }
for example in "$root"/plugins/examples/*/; do
    name=$(basename "$example")
    cp -r "$example" "$work/$name"
    # Outside of the repository the path of the patch is another one.
    { others "$example/Cargo.toml" | sed "s|path = \"../../../crates|path = \"$root/crates|"; profiles "$root/Cargo.toml"; } \
        >"$work/$name/Cargo.toml"
    # What the workspace's macros and tests ask of these crates: with other features much of the program would be built again.
    if [ ${#with[@]} -eq 0 ]; then
        cat >>"$work/$name/Cargo.toml" <<'EOF'

[dependencies.num-traits]
version = "*"
default-features = false
features = ["libm"]

[dependencies.rand]
version = "*"
default-features = false
features = ["std", "sys_rng"]

[target.'cfg(unix)'.dependencies.rustix]
version = "*"
default-features = false
features = ["fs", "std"]

[build-dependencies]
proc-macro2 = { version = "1", features = ["span-locations"] }
EOF
    fi
    cp "$root/Cargo.lock" "$work/$name/Cargo.lock"
    (cd "$work/$name" && cargo clippy -q --all-targets -- -D warnings && cargo test -q)
    with+=(--with "$work/$name")
done
cd "$work"
SPECTRA_CACHE=$work/cache "$program" build "${with[@]}" --core "$root" --profile dev -o spectra-mine
"${PYTHON:-python3}" "$root/xtask/validate_schemas.py" ./spectra-mine
for name in axicon diffusion-filter night-vision lenslets; do
    ./spectra-mine run "$name/scene.yaml" --samples 16 --output "out/$name" --quiet
    test -s "out/$name/scene.png"
done
echo "$(ls out | wc -l) pictures"
if [ -n "${PICTURES:-}" ]; then cp -r out/. "$PICTURES"; fi
