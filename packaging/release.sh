#!/usr/bin/env bash
# Builds all packages into dist/, and prints how each was tried.
#
#   packaging/release.sh [--with-windows] [--in-fresh-debian]
#
# Linux: an archive, a Debian package and the Python wheel. --with-windows adds the zip for Windows
# (40 minutes of processor time); --in-fresh-debian installs the Debian package in a fresh Debian, as
# root. A modified source is built too; `gdcm --version` then says "modified".
set -euo pipefail
root=$(cd "$(dirname "$0")/.." && pwd)
cd "$root"
with_windows=
in_fresh_debian=
for option in "$@"; do
  case $option in
    --with-windows) with_windows=yes ;;
    --in-fresh-debian) in_fresh_debian=yes ;;
    *) sed -n '2,8s/^# \{0,1\}//p' "$0"; exit 2 ;;
  esac
done
version=$(sed -n '/^\[workspace.package\]/,/^\[/s/^version = "\(.*\)"/\1/p' Cargo.toml)
export SOURCE_DATE_EPOCH="${SOURCE_DATE_EPOCH:-$(git log -1 --format=%ct 2>/dev/null || date +%s)}"
dist=$root/dist
tried=()
not_tried=()
mkdir -p "$dist"
rm -f "$dist"/*

# The program, without paths of this machine.
export CARGO_TARGET_DIR="${CARGO_TARGET_DIR:-$root/target}"
export RUSTFLAGS="${RUSTFLAGS:-} --remap-path-prefix=$root=gdcm --remap-path-prefix=${CARGO_HOME:-$HOME/.cargo}=cargo"
cargo build --locked --release --bin gdcm
program=$CARGO_TARGET_DIR/release/gdcm
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# Archive for Linux with this machine's glibc or a later version.
name=gdcm-$version-linux-$(uname -m)
folder=$work/$name
mkdir -p "$folder/man"
cp "$program" "$folder/"
"$program" man-pages "$folder/man"
cp README.md CHANGELOG.md LICENSE-MIT LICENSE-APACHE assets/licences.txt assets/icon/gdcm.svg packaging/linux/gdcm.desktop \
  packaging/linux/gdcm-study.xml "$folder/"
tar --sort=name --owner=0 --group=0 --numeric-owner --mtime="@$SOURCE_DATE_EPOCH" -C "$work" -cf - "$name" |
  xz -9 -T1 > "$dist/$name.tar.xz"
mkdir "$work/unpacked"
tar -C "$work/unpacked" -xf "$dist/$name.tar.xz"
(cd "$work/unpacked/$name" && ./gdcm --version && ./gdcm example . >/dev/null &&
  ./gdcm analyze example-dataset.json --reject-suggested --out results >/dev/null &&
  ./gdcm analyze example-dataset.json --reject-suggested --out results --force >/dev/null &&
  cd results && sha256sum --quiet -c ./*.sha256)
tried+=("$name.tar.xz: unpacked; --version, example, analyze, analyze --force, checksums of the results")

# Source archive, which states its commit.
if git rev-parse --git-dir >/dev/null 2>&1; then
  git archive --format=tar --prefix="gdcm-$version/" HEAD | xz -9 -T1 > "$dist/gdcm-$version-source.tar.xz"
  tar -xOf "$dist/gdcm-$version-source.tar.xz" "gdcm-$version/packaging/source-commit.txt" | grep -qx "$(git rev-parse HEAD)"
  tried+=("gdcm-$version-source.tar.xz: states the commit")
fi

# Debian package.
if cargo deb --version >/dev/null 2>&1; then
  GDCM_IS_BUILT=yes packaging/debian/build.sh "$dist"
  tried+=("gdcm_$version-1_$(dpkg --print-architecture).deb: lintian and the validators that are installed")
  if [ -n "$in_fresh_debian" ]; then
    packaging/debian/try.sh "$dist"/gdcm_*.deb "$CARGO_TARGET_DIR/gdcm-in-debian.png"
    tried+=("gdcm_$version-1_$(dpkg --print-architecture).deb: installed in a fresh Debian; commands and window")
  else
    not_tried+=("the Debian package in a fresh Debian (--in-fresh-debian)")
  fi
else
  not_tried+=("Debian package: cargo-deb is not installed")
fi

# Python wheel.
if [ -x packaging/wheel ]; then
  packaging/wheel "$dist"
  tried+=("wheel: by packaging/wheel")
else
  not_tried+=("Python wheel: packaging/wheel is not there")
fi

# Windows.
if [ -n "$with_windows" ]; then
  env -u RUSTFLAGS packaging/windows/build.sh "$dist"
  tried+=("zip for Windows: under Wine only; example, analyze --force, identify, the window")
else
  not_tried+=("zip for Windows (--with-windows)")
fi

(cd "$dist" && sha256sum -- * > SHA256SUMS && ls -l)
printf '\ntried:\n'
printf '  %s\n' "${tried[@]}"
if [ ${#not_tried[@]} -gt 0 ]; then
  printf 'not built or not tried:\n'
  printf '  %s\n' "${not_tried[@]}"
fi
