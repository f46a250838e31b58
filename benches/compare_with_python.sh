#!/bin/sh
# Compares time and error of frequency responses on the same models: gdcm, python-control (with and
# without slycot), SciPy and NumPy.
#
#     sh benches/compare_with_python.sh
#
# Needs Python 3.11 or later with its venv module, and a network for the first run. All files are in
# target/compare-python. Where slycot has no wheel (Linux on x86-64 has one), the script installs the
# Debian packages to build it, if run by root.
set -eu
cd "$(dirname "$0")/.."

environment=target/compare-python
exported=$PWD/$environment/responses
# Packages to build slycot from source (pip fetches CMake); the headers are for Debian's Python.
build_packages="gfortran libopenblas-dev python3-dev"

install() {
    "$environment/bin/pip" install --quiet --disable-pip-version-check "$@"
}

install_slycot() {
    install slycot==0.7.1
}

install_build_packages() {
    [ "$(id -u)" -eq 0 ] && apt-get install --yes --no-install-recommends $build_packages >&2
}

python3 -m venv "$environment"
install numpy==2.4.6 scipy==1.17.1 control==0.10.2
install_slycot || { install_build_packages && install_slycot; } ||
    echo "slycot cannot be built here, so it is left out. It needs (Debian): $build_packages" >&2

mkdir -p "$exported"
GDCM_EXPORT_RESPONSES="$exported" cargo bench --bench responses

# One thread, like gdcm; the libraries read these variables when they are loaded.
export OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 MKL_NUM_THREADS=1
"$environment/bin/python" benches/compare_with_python.py "$exported"
