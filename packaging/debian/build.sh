#!/usr/bin/env bash
# Builds the Debian package, and checks it with lintian.
#
#   packaging/debian/build.sh [DIRECTORY OF THE PACKAGE, default dist]
#
# Needs cargo-deb 3 (cargo install --locked cargo-deb), rsvg-convert and, to check, lintian.
set -euo pipefail
root=$(cd "$(dirname "$0")/../.." && pwd)
dist=$(realpath -m "${1:-$root/dist}")
cd "$root"
version=$(sed -n '/^\[workspace.package\]/,/^\[/s/^version = "\(.*\)"/\1/p' Cargo.toml)
# Dates are taken from the commit, so that the same source gives the same package.
export SOURCE_DATE_EPOCH="${SOURCE_DATE_EPOCH:-$(git log -1 --format=%ct 2>/dev/null || date +%s)}"
files=target/debian-files
rm -rf "$files"
mkdir -p "$files/man" "$dist"

if [ -z "${GDCM_IS_BUILT:-}" ]; then
  cargo build --locked --release --bin gdcm
fi
"${CARGO_TARGET_DIR:-target}/release/gdcm" man-pages "$files/man"
rsvg-convert -w 48 -h 48 assets/icon/gdcm.svg -o "$files/gdcm-48.png"
sed -e "s/@VERSION@/$version/" -e "s/@DATE@/$(date -u -d "@$SOURCE_DATE_EPOCH" +%F)/" \
  packaging/linux/metainfo.xml.in > "$files/io.github.gdcm.gdcm.metainfo.xml"
cat > "$files/changelog" <<END
gdcm ($version-1) unstable; urgency=medium

  * Version $version. What is new is in NEWS.md.

 -- $(sed -n 's/^maintainer = "\(.*\)"/\1/p' Cargo.toml)  $(date -u -R -d "@$SOURCE_DATE_EPOCH")
END
cargo deb --no-build --no-strip --locked --output "$dist/gdcm_$version-1_$(dpkg --print-architecture).deb"
package=$dist/gdcm_$version-1_$(dpkg --print-architecture).deb
echo "built: $package ($(du -h "$package" | cut -f1))"
if command -v desktop-file-validate >/dev/null; then
  desktop-file-validate packaging/linux/gdcm.desktop
  echo "tried: desktop-file-validate"
fi
if command -v appstreamcli >/dev/null; then
  appstreamcli validate --no-net "$files/io.github.gdcm.gdcm.metainfo.xml"
  echo "tried: appstreamcli validate"
fi
if command -v lintian >/dev/null; then
  # Suppressed: the number of a bug report, which only packages in Debian's archive need.
  lintian --allow-root --fail-on error,warning --suppress-tags initial-upload-closes-no-bugs "$package"
  echo "tried: lintian, no error and no warning"
fi
