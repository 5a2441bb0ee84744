#!/usr/bin/env bash
# Packs the build BUILD as cpack does, without compiling anything, and runs the program as the packages bring it: unpacked
# beside; with ORBIFIT_BARE_ROOT=DIR installed in the bare Debian root DIR, made by debootstrap where it is not there yet
# (as root, with network: a minute or two).
set -euo pipefail
build=$1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

fail() { echo "$*" && exit 1; }

# pipeline OUT PROGRAM ...: a model, its symmetries as found, and that it has them.
pipeline() {
  local out=$1
  shift
  "$@" generate chair -o "$out" --quiet >/dev/null
  "$@" detect "$out/chair.ply" -o "$out/chair.json" --quiet >/dev/null
  "$@" check "$out/chair.ply" "$out/chair.json" --max-residual 1e-9 --quiet >/dev/null
}

(cd "$build" && cpack -B "$work/packages" >"$work/log" 2>&1) || { cat "$work/log" && exit 1; }
archive=$(echo "$work"/packages/*.tar.gz)
deb=$(echo "$work"/packages/orbifit_*.deb)
development=$(echo "$work"/packages/liborbifit-dev_*.deb)
compare=$(echo "$work"/packages/orbifit-compare_*.deb)
for file in "$archive" "$deb" "$development" "$compare"; do
  echo "$(basename "$file"): $(($(stat -c %s "$file") / 1000)) kB"
done

# What the program needs is declared, and nothing of it is under the GPL; that is the business of orbifit-compare.
needs=$(dpkg-deb -f "$deb" Depends)
echo "orbifit depends on $needs"
for library in libc6 libstdc++6 libembree3 libtbb12 liblz4-1 libdraco7 lib3mf1 libzip4; do
  [[ $needs == *"$library"* ]] || fail "the dependency on $library is missing"
done
gpl='libceres|libcholmod|libspqr|libsuitesparse|libumfpack'
[[ ! $needs =~ $gpl ]] || fail "orbifit must not depend on libraries under the GPL"
[[ $(dpkg-deb -f "$compare" Depends) =~ $gpl ]] || fail "orbifit-compare should depend on Ceres"
for name in libeigen3-dev libembree-dev libtbb-dev liblz4-dev libdraco-dev lib3mf-dev libzip-dev; do
  [[ $(dpkg-deb -f "$development" Depends) == *"$name"* ]] || fail "liborbifit-dev: the dependency on $name is missing"
done

# Unpacked beside: both packages have the program, the archive has the libraries as well.
dpkg-deb -x "$deb" "$work/deb"
mkdir "$work/archive" "$work/from_deb" "$work/from_archive"
tar xzf "$archive" -C "$work/archive" --strip-components 1
if ldd "$work/deb/usr/bin/orbifit" | grep -E "not found|$gpl"; then fail "orbifit does not find its libraries"; fi
pipeline "$work/from_deb" "$work/deb/usr/bin/orbifit"
pipeline "$work/from_archive" "$work/archive/bin/orbifit"
for file in include/orbifit/model/mesh.h include/orbifit/interop/pcl.h share/doc/orbifit/copyright; do
  [ -f "$work/archive/$file" ] || fail "$file is missing in the archive"
done
find "$work/archive" -name orbifitConfig.cmake | grep -q . || fail "the archive lacks what find_package needs"
if find "$work/archive" | grep -E 'orbifit-compare|orbifit_baselines|libgcc_s'; then fail "that is not for the archive"; fi

[ -n "${ORBIFIT_BARE_ROOT:-}" ] || exit 0
root=$ORBIFIT_BARE_ROOT
[ -x "$root/bin/sh" ] || debootstrap --variant=minbase bookworm "$root" >"$work/log" 2>&1 || { cat "$work/log" && exit 1; }
run_inside=(chroot "$root" env LC_ALL=C DEBIAN_FRONTEND=noninteractive)
rm -rf "$root/orbifit_test" && mkdir "$root/orbifit_test"
cp "$deb" "$root/orbifit_test/orbifit.deb"
"${run_inside[@]}" apt-get update -qq
"${run_inside[@]}" apt-get install -y -qq --no-install-recommends /orbifit_test/orbifit.deb >"$work/log" 2>&1 ||
  { cat "$work/log" && exit 1; }
pipeline /orbifit_test "${run_inside[@]}" orbifit
"${run_inside[@]}" apt-get purge -y -qq orbifit >/dev/null 2>&1
[ ! -e "$root/usr/bin/orbifit" ] || fail "purging the package leaves the program"
rm -rf "$root/orbifit_test"
echo "installed in $root, run, and removed again"
