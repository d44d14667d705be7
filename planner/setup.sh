# SPDX-License-Identifier: AGPL-3.0-or-later
# Sourced by planner/run and tests/run: installs packages on Debian and builds. Expects $root.

say() { printf '\n== %s\n' "$*"; }

# Further options for CMake.
configure_options=()

# What a build of the program takes, on Debian 12.
build_packages=(
  ca-certificates cmake esbuild g++ ninja-build pkg-config
  libboost-dev libcgal-dev libcli11-dev libcurl4-openssl-dev libeigen3-dev libexpat1-dev libgdcm-dev libglm-dev libinsighttoolkit5-dev libisal-dev liblz4-dev libjpeg62-turbo-dev
  libminizip-dev libnifti-dev libopenimageio-dev libopenmesh-dev libsqlite3-dev libssl-dev libtbb-dev libtet1.5-dev libzstd-dev nlohmann-json3-dev zlib1g-dev
)

# Installs those of the named packages that are missing; asks for no password where none is.
install_packages() {
  local missing=()
  for package in "$@"; do
    dpkg-query -W -f='${Status}' "$package" 2>/dev/null | grep -q '^install ok installed$' || missing+=("$package")
  done
  [ ${#missing[@]} -eq 0 ] && return
  say "Installing ${missing[*]}"
  local as_root=()
  if [ "$(id -u)" -ne 0 ]; then
    command -v sudo >/dev/null || {
      echo "These packages are missing and installing them takes root: ${missing[*]}" >&2
      exit 3
    }
    as_root=(sudo)
  fi
  "${as_root[@]}" apt-get update -q
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -q -y --no-install-recommends "${missing[@]}"
}

# Configures build/PRESET as .cmake/PRESET.cmake and the array configure_options say, and builds the named targets there.
# Warnings are errors in the developers' presets and in continuous integration; for users of another compiler than ours a
# warning is none.
build() {
  local preset=$1
  shift
  say "Building build/$preset (the first time takes some minutes)"
  cmake -C "$root/.cmake/$preset.cmake" -S "$root" -B "$root/build/$preset" -G Ninja --log-level=WARNING \
    "${configure_options[@]}" >/dev/null
  cmake --build "$root/build/$preset" --target "$@"
}
