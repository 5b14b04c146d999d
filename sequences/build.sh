# Sourced by sequences/demo and tests/run: installs what is missing, configures and builds release.
# shellcheck shell=bash

# install_packages [PACKAGE...]: those of packages.txt unless named.
install_packages() {
  local wanted package missing=()
  wanted=${*:-$(sed -e 's/#.*//' packages.txt)}
  for package in $wanted; do
    dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null | grep -qx installed ||
      missing+=("$package")
  done
  ((${#missing[@]} == 0)) && return
  local sudo=""
  [[ "$(id -u)" == 0 ]] || sudo="sudo"
  echo "installing: ${missing[*]}"
  $sudo apt-get update -qq
  DEBIAN_FRONTEND=noninteractive $sudo apt-get -o DPkg::Lock::Timeout=600 install -y -qq \
    --no-install-recommends "${missing[@]}" >/dev/null
}

# build PRESET [TARGET...]
build() {
  local preset="$1"
  shift
  cmake --preset "$preset" >/dev/null
  cmake --build "build/$preset" ${1:+--target "$@"}
}
