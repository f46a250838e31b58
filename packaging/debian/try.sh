#!/usr/bin/env bash
# Installs a package in a fresh Debian and tries it: the commands without the recommended packages,
# then the window on a virtual display, with a screenshot.
#
#   packaging/debian/try.sh PACKAGE.deb [PICTURE.png]
#
# Runs as root; needs mmdebstrap, Xvfb, xdotool and import (ImageMagick).
set -euo pipefail
package=$(realpath "$1")
picture=$(realpath -m "${2:-gdcm-in-debian.png}")
suite=${GDCM_DEBIAN:-bookworm}
work=$(mktemp -d)
chroot=$work/$suite
running=()
cleanup() {
  for process in "${running[@]}"; do kill "$process" 2>/dev/null || true; done
  umount "$chroot/tmp/.X11-unix" "$chroot/proc" 2>/dev/null || true
  rm -rf --one-file-system "$work"
}
trap cleanup EXIT

mmdebstrap --quiet --variant=apt "$suite" "$chroot"
cp "$package" "$chroot/tmp/gdcm.deb"
mount -t proc proc "$chroot/proc"
inside() { env -i HOME=/root LANG=C.UTF-8 DEBIAN_FRONTEND=noninteractive PATH=/usr/sbin:/usr/bin:/sbin:/bin "$@"; }
inside chroot "$chroot" apt-get install -qq -o Dpkg::Use-Pty=0 --no-install-recommends /tmp/gdcm.deb >/dev/null 2>&1
inside chroot "$chroot" gdcm --version
inside chroot "$chroot" sh -ec 'cd /root && gdcm example . >/dev/null && gdcm analyze example-dataset.json --reject-suggested --out results >/dev/null && ls results'
inside chroot "$chroot" sh -ec 'cd /root && gdcm analyze example-dataset.json --reject-suggested --out results --force >/dev/null'
inside chroot "$chroot" test -s /usr/share/man/man1/gdcm-analyze.1.gz
echo "tried in a fresh Debian $suite: install, gdcm --version, example, analyze, analyze --force"

# Remove the package and install it again with the recommended packages, which the window needs: apt
# installs them only with a new package.
inside chroot "$chroot" apt-get purge -qq -o Dpkg::Use-Pty=0 gdcm >/dev/null
inside chroot "$chroot" sh -c '! test -e /usr/bin/gdcm && ! test -e /usr/share/doc/gdcm'
inside chroot "$chroot" apt-get update -qq
inside chroot "$chroot" apt-get install -qq -o Dpkg::Use-Pty=0 --install-recommends /tmp/gdcm.deb >/dev/null 2>&1
display=:$((RANDOM % 400 + 200))
Xvfb "$display" -screen 0 1440x900x24 -nolisten tcp >/dev/null 2>&1 &
running+=($!)
mkdir -p "$chroot/tmp/.X11-unix"
mount --bind /tmp/.X11-unix "$chroot/tmp/.X11-unix"
inside DISPLAY="$display" chroot "$chroot" gdcm &
running+=($!)
window=$(DISPLAY=$display timeout 60 xdotool search --sync --onlyvisible --class gdcm | head -n 1)
test -n "$window"
sleep 5 # until the first results are drawn
DISPLAY=$display import -window root "$picture"
kill -0 "${running[1]}"
echo "tried in a fresh Debian $suite: the window; picture $picture"
