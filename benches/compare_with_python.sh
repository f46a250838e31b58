#!/bin/sh
# Frequency responses of gdcm beside those of python-control (with and without slycot), SciPy and
# NumPy on the same models: time and error.
#
#     sh benches/compare_with_python.sh
#
# Needs Python 3.11 or later with its venv module, and a network at the first run. Everything stays
# in target/compare-python, except the Debian packages that slycot needs where there is no wheel of
# it (there is one for Linux on x86-64): run by root, this script installs them.
set -eu
cd "$(dirname "$0")/.."

environment=target/compare-python
exported=$PWD/$environment/responses
# What slycot is built with from its source (pip fetches CMake); the headers are for Debian's Python.
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

# One thread, like gdcm; the libraries read these when they are loaded.
export OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 MKL_NUM_THREADS=1
"$environment/bin/python" benches/compare_with_python.py "$exported"
