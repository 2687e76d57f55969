#!/bin/sh
# Installs what is missing of the Debian 12 packages that Valsalva builds and runs with. Does nothing, quickly, when
# all are there. Needs root only when something is missing.
set -eu

packages="
  g++ cmake ninja-build pkg-config git python3
  libeigen3-dev libfmt-dev libspdlog-dev nlohmann-json3-dev libtomlplusplus-dev libssl-dev libgtest-dev
  libopenmpi-dev openmpi-bin libhdf5-openmpi-dev libpetsc-real-dev libfftw3-dev libblis4-serial
  libcgal-dev libgmsh-dev libmuparser-dev libopenvdb-dev libboost-iostreams-dev libboost-system-dev libtbb-dev libblosc-dev
  libjemalloc-dev libinsighttoolkit5-dev libpng-dev zlib1g-dev
  libjs-three
  chromium python3-vtk9 python3-h5py python3-numpy python3-scipy python3-matplotlib clang-format clang-tidy
"
missing=""
for package in $packages; do
  status=$(dpkg-query -W -f='${db:Status-Abbrev}' "$package" 2>/dev/null || true)
  case "$status" in ii*) ;; *) missing="$missing $package" ;; esac
done
[ -z "$missing" ] && exit 0

if [ "$(id -u)" -ne 0 ]; then
  echo "setup: these Debian packages are missing and only root can install them:$missing" >&2
  exit 4
fi
echo "setup: installing$missing"
export DEBIAN_FRONTEND=noninteractive
apt-get update -qq
# shellcheck disable=SC2086
apt-get install -y -qq --no-install-recommends $missing >/dev/null
