#!/usr/bin/env bash
# Tries a zip for Windows under Wine: the commands example, analyze, analyze --force and identify, and
# the window started by gdcm-window.exe, with a screenshot. Compares the results with those of a Linux
# program, if given.
#
#   packaging/windows/try.sh ZIP [LINUX PROGRAM]
#
# Needs wine64, Xvfb, xdotool, import, and the compiler of build.sh.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
root=$(cd "$here/../.." && pwd)
work=$(realpath -m "${GDCM_WINDOWS_WORK:-$root/target/windows}")
zip=$(realpath "$1")
linux=${2:+$(realpath "$2")}
compiler=$work/compiler
trial=$work/trial
rm -rf "$trial"
mkdir -p "$trial"
(cd "$trial" && unzip -q "$zip")
folder=$(echo "$trial"/gdcm-*)
export WINEPREFIX=$work/wine WINEDEBUG=-all WINEDLLOVERRIDES="mscoree,mshtml="
wine=$(command -v wine64 || echo /usr/lib/wine/wine64)
running=()
cleanup() {
  for process in "${running[@]}"; do kill "$process" 2>/dev/null || true; done
  "$(dirname "$wine")/wineserver64" -k 2>/dev/null || /usr/lib/wine/wineserver64 -k 2>/dev/null || true
}
trap cleanup EXIT

# Wine 8 lacks the Windows library from which Rust takes random numbers. This replacement is used
# under Wine only and is in no package.
for place in "$folder" "$folder/bin"; do
  env LD_LIBRARY_PATH="$compiler/usr/lib/x86_64-linux-gnu" PATH="$compiler/usr/bin:$PATH" \
    x86_64-w64-mingw32-gcc-win32 -shared -o "$place/bcryptprimitives.dll" "$here/bcryptprimitives.c" \
    -ladvapi32
done

gdcm() { "$wine" "$folder/bin/gdcm.exe" "$@"; }
cd "$trial"
cp "$root/assets/example-records-3-and-10.zip" .
gdcm --version
gdcm example . >/dev/null
gdcm analyze example-dataset.json --reject-suggested --out results >/dev/null
cp -r results first
gdcm analyze example-dataset.json --reject-suggested --out results --force >/dev/null
(cd results && sha256sum --quiet -c ./*.sha256)
cmp results/corrections.csv first/corrections.csv
gdcm identify example-records-3-and-10.zip --into example-dataset.json --every-condition --take with-unrefined \
  --out identified >/dev/null 2>identify.log
status=0
gdcm check missing.json >/dev/null 2>&1 || status=$?
[ "$status" = 2 ]
echo "tried under Wine: --version, example, analyze, analyze --force, checksums, identify, exit status"

if [ -n "$linux" ]; then
  mkdir linux
  (cd linux && cp ../example-records-3-and-10.zip . && "$linux" example . >/dev/null && cmp example-dataset.json ../example-dataset.json &&
    "$linux" analyze example-dataset.json --reject-suggested --out results >/dev/null &&
    "$linux" identify example-records-3-and-10.zip --into example-dataset.json --every-condition --take with-unrefined \
      --out identified >/dev/null 2>&1)
  python3 "$here/compare.py" results/corrections.json linux/results/corrections.json
  for file in linux/identified/identified-condition-*.json; do
    python3 "$here/compare.py" "identified/$(basename "$file")" "$file" || true
  done
  echo "compared with the program for Linux"
fi

display=:$((RANDOM % 400 + 200))
Xvfb "$display" -screen 0 1440x900x24 -nolisten tcp >/dev/null 2>&1 &
running+=($!)
export DISPLAY=$display
for _ in $(seq 100); do
  xdotool getdisplaygeometry >/dev/null 2>&1 && break
  sleep 0.1
done
"$wine" "$folder/gdcm-window.exe" &
running+=($!)
timeout 120 xdotool search --sync --onlyvisible --name '^gdcm|gdcm$' >/dev/null
sleep "${GDCM_WAIT:-20}"
import -window root "$work/window.png"
# Only the window must be open, without a console.
names=$(xdotool search --onlyvisible --name '.*' 2>/dev/null | while read -r id; do xdotool getwindowname "$id"; done | sort -u)
echo "windows on the screen: $names"
if grep -qi 'console\|gdcm.exe' <<< "$names"; then
  echo "a console is open beside the window" >&2
  exit 1
fi
echo "tried under Wine: gdcm-window.exe; picture $work/window.png"
