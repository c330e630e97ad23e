#!/bin/sh
# make_system.sh FOLDER: makes FOLDER the root of a system with the C library, the OpenGL drivers, the users and a shell
# of this one. Debian's own image has package tools, Perl and other programs that a server never starts.
set -eu
root=$1
libraries=usr/lib/$(uname -m)-linux-gnu
scripts=$(cd "$(dirname "$0")" && pwd)
cd /

install -d "$root/$libraries"
find . -maxdepth 1 -type l | while read -r link; do # lib -> usr/lib and its like
  install -d "$root$(readlink -f "$link")"
  cp --no-dereference "$link" "$root"
done

# All of the C library but its character sets: NVIDIA's driver links parts of it that Mesa does not.
dpkg --listfiles libc6 | sed -n 's|^/\(.*/lib[^/]*\.so[^/]*\)$|\1|p; s|^/\(.*/ld-linux[^/]*\)$|\1|p' |
  grep --invert-match -e /gconv/ -e /audit/ | while read -r file; do
  cp --no-dereference "$file" "$root/$file"
done

# By these, NVIDIA's container toolkit knows where to put the driver's libraries, and libEGL finds a driver. The names
# of Mesa's drivers are hard links to one file, which --archive keeps.
# By the certificates, stores of models are known.
cp --archive --parents "$libraries/dri" etc/debian_version etc/os-release usr/lib/os-release etc/ld.so.conf \
  etc/ld.so.conf.d etc/nsswitch.conf etc/passwd etc/group etc/ssl/certs/ca-certificates.crt usr/share/drirc.d usr/share/glvnd usr/share/libdrm "$root"
by_name="$libraries/libEGL.so.1 $libraries/libEGL_mesa.so.0 $libraries/libOpenGL.so.0"
by_name="$by_name $libraries/libX11.so.6" # for versions of NVIDIA's driver that link it
cp --dereference $by_name "$root/$libraries"
cp bin/busybox "$root/bin/busybox"
"$scripts/collect_libraries.sh" "$root" "$root/$libraries" $by_name "$libraries/dri/swrast_dri.so" bin/busybox
busybox --install -s "$root/usr/bin"
