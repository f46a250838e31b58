#!/usr/bin/env bash
# Builds the Windows program on a Debian machine, packs it into a zip, and tries its commands and its
# window under Wine.
#
#   packaging/windows/build.sh [DIRECTORY OF THE ZIP, default dist]
#
# Not part of .ci/run: it takes about 40 minutes of processor time. GDCM_WINDOWS_WORK names the working
# folder for compiler, build and trial results (default target/windows). Needs apt-get, dpkg-deb, zip,
# rsvg-convert and wine64.
#
# Where rustup has no standard library for Windows, Debian's package rustc-web provides its source, and
# cargo builds it (-Zbuild-std). The packages are unpacked instead of installed, because they conflict
# with rustup's compiler.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
root=$(cd "$here/../.." && pwd)
dist=$(realpath -m "${1:-$root/dist}")
work=$(realpath -m "${GDCM_WINDOWS_WORK:-$root/target/windows}")
version=$(sed -n '/^\[workspace.package\]/,/^\[/s/^version = "\(.*\)"/\1/p' "$root/Cargo.toml")
name=gdcm-$version-windows-x86_64
target=x86_64-pc-windows-gnu
compiler=$work/compiler
mkdir -p "$work" "$dist"

packages=(
  rustc-web libstd-rust-web-1.96 libstd-rust-web-dev rust-web-src libllvm22 lld-22 liblld-22
  gcc-mingw-w64-x86-64-win32 gcc-mingw-w64-x86-64-win32-runtime gcc-mingw-w64-base
  binutils-mingw-w64-x86-64 mingw-w64-x86-64-dev mingw-w64-common
)

get_compiler() {
  [ -x "$compiler/usr/bin/rustc" ] && return
  mkdir -p "$work/packages" "$compiler"
  (cd "$work/packages" && apt-get download -q "${packages[@]}")
  for package in "$work"/packages/*.deb; do
    dpkg-deb -x "$package" "$compiler"
  done
}

# Resources: icon and version for the file manager of Windows.
make_resources() {
  mkdir -p "$work/resources"
  for size in 16 32 48 64 256; do
    rsvg-convert -w $size -h $size "$root/assets/icon/gdcm.svg" -o "$work/resources/gdcm-$size.png"
  done
  python3 "$here/make_ico.py" "$work/resources/gdcm.ico" "$work"/resources/gdcm-{16,32,48,64,256}.png
  sed -e "s/@VERSION@/$version/g" -e "s/@NUMBERS@/${version//./,},0/g" "$here/gdcm.rc" > "$work/resources/gdcm.rc"
  (cd "$work/resources" && with_compiler x86_64-w64-mingw32-windres --preprocessor=cat gdcm.rc -O coff -o resources.o)
}

with_compiler() {
  env LD_LIBRARY_PATH="$compiler/usr/lib/x86_64-linux-gnu" PATH="$compiler/usr/bin:$PATH" "$@"
}

build() {
  # Keep paths of this machine out of the program.
  local flags="--remap-path-prefix=$root=gdcm --remap-path-prefix=${CARGO_HOME:-$HOME/.cargo}=cargo --remap-path-prefix=$compiler=compiler"
  (cd "$root" && with_compiler env RUSTC="$compiler/usr/bin/rustc" RUSTC_BOOTSTRAP=1 RUSTFLAGS="$flags" \
    CARGO_TARGET_DIR="$work/build" \
    cargo rustc --locked --release "$@" -Zbuild-std=std,panic_abort --target $target \
    --config "target.$target.linker='$compiler/usr/bin/x86_64-w64-mingw32-gcc-win32'" \
    -- -C "link-arg=$work/resources/resources.o")
}

pack() {
  local folder=$work/$name
  rm -rf "$folder"
  mkdir -p "$folder/bin"
  cp "$work/build/$target/release/gdcm.exe" "$folder/bin/"
  cp "$work/build/$target/release/gdcm-window.exe" "$folder/"
  sed "s/@VERSION@/$version/g; s/$/\r/" "$here/README.txt" > "$folder/README.txt"
  cp "$root/LICENSE-MIT" "$root/LICENSE-APACHE" "$root/assets/licences.txt" "$folder/"
  rm -f "$dist/$name.zip"
  # Fixed time stamps and -X (no extra attributes): the same program gives the same zip.
  find "$folder" -exec touch -d "@${SOURCE_DATE_EPOCH:-$(git -C "$root" log -1 --format=%ct 2>/dev/null || echo 315619200)}" {} +
  (cd "$work" && find "$name" | LC_ALL=C sort | TZ=UTC zip -qX "$dist/$name.zip" -@)
}

get_compiler
make_resources
build --bin gdcm
build -p gdcm-window
pack
echo "built: $dist/$name.zip ($(du -h "$dist/$name.zip" | cut -f1))"
"$here/try.sh" "$dist/$name.zip"
