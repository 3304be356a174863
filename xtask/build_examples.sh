#!/usr/bin/env bash
# Tests, builds in and renders the plugins of plugins/examples, each copied out of the repository first: as a stranger's
# crates. Needs the program: SPECTRA names it, or it is built. Profile, features and places of our crates are those of this
# workspace's tests, so that what these were built from is not built again.
set -euo pipefail
root=$(cd "$(dirname "$0")/.." && pwd)
target=${CARGO_TARGET_DIR:-$root/target}
program=${SPECTRA:-$target/debug/spectra}
[ -x "$program" ] || (cd "$root" && cargo build --locked)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
export CARGO_TARGET_DIR=$target
with=()

# The tables of a manifest whose head does, or does not, match.
tables() { awk -v wanted="$2" -v head="$3" '/^\[/ { kept = ($0 ~ head) == wanted } kept && !/^#/' "$1"; }
ours='^\\[(profile|workspace)\\.'

# Lets the crate in a folder find our crates below itself, where this workspace has them below its own root: cargo tells crates
# apart by their place below the root, their features and how they are compiled. What the workspace's macros and tests ask of
# num-traits, rand, rustix and proc-macro2 is asked for as well: with other features much would be built again.
beside_ours() {
    ln -sfn "$root/crates" "$1/crates"
    ln -sfn "$root/plugins" "$1/plugins"
    {
        tables "$1/Cargo.toml" 0 "$ours" | sed "s|\"../../../crates|\"crates|; s|\"$root/|\"|"
        cat <<'EOF'

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
        tables "$root/Cargo.toml" 1 "$ours"
    } >"$1/Cargo.toml.new"
    mv "$1/Cargo.toml.new" "$1/Cargo.toml"
}

for example in "$root"/plugins/examples/*/; do
    name=$(basename "$example")
    cp -r "$example" "$work/$name"
    cp -r "$example" "$work/$name-beside"
    beside_ours "$work/$name-beside"
    cp "$root/Cargo.lock" "$work/$name-beside/Cargo.lock"
    (cd "$work/$name-beside" && cargo clippy -q --all-targets -- -D warnings && cargo test -q)
    with+=(--with "$work/$name")
done
cd "$work"
# `spectra build` writes a program and calls `$CARGO`: this one puts what is to be built beside our crates first.
cat >beside-cargo <<EOF
#!/usr/bin/env bash
set -euo pipefail
$(declare -p root ours)
$(declare -f tables beside_ours)
if [ "\$1" = build ] && [ ! -e "\$(dirname "\$3")/crates" ]; then beside_ours "\$(dirname "\$3")"; fi
exec cargo "\$@"
EOF
chmod +x beside-cargo
CARGO=$work/beside-cargo SPECTRA_CACHE=$work/cache "$program" build "${with[@]}" --core "$root" --profile dev -o spectra-mine
"${PYTHON:-python3}" "$root/xtask/validate_schemas.py" ./spectra-mine
for name in axicon diffusion-filter night-vision lenslets; do
    ./spectra-mine run "$name/scene.yaml" --samples 16 --output "out/$name" --quiet
    test -s "out/$name/scene.png"
done
echo "$(ls out | wc -l) pictures"
if [ -n "${PICTURES:-}" ]; then cp -r out/. "$PICTURES"; fi
