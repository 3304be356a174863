#!/usr/bin/env bash
# Tests the plugins of plugins/examples, builds a program with them and renders their scenes. Each plugin is first copied out of the
# repository, like a crate of somebody else. Uses the program that SPECTRA names, or builds it. Profile, features and paths of our
# crates are those of this workspace's tests, so that nothing is built twice.
set -euo pipefail
root=$(cd "$(dirname "$0")/.." && pwd)
target=${CARGO_TARGET_DIR:-$root/target}
program=${SPECTRA:-$target/debug/spectra}
[ -x "$program" ] || (cd "$root" && cargo build --locked)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
export CARGO_TARGET_DIR=$target
with=()

# Prints the tables of a manifest whose header matches a pattern (1) or does not (0).
tables() { awk -v wanted="$2" -v head="$3" '/^\[/ { kept = ($0 ~ head) == wanted } kept && !/^#/' "$1"; }
ours='^\\[(profile|workspace)\\.'

# Lets the crate in a folder find our crates at the same relative paths as this workspace has them below its root: cargo identifies
# a crate by its path below the root, its features and its compiler settings. Also requests the features of num-traits, rand, rustix
# and proc-macro2 that the workspace's macros and tests use. With other features, much would be built again.
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
# `spectra build` writes a program and calls `$CARGO`. This cargo first links our crates into the folder to be built.
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
