#!/bin/sh
# fetch_kernel.sh FOLDER: Debian's kernel for the guest, unpacked into FOLDER, never installed.
# Leaves FOLDER/vmlinuz and FOLDER/modules; does nothing if they are there.
set -eu
folder=$1
[ -f "$folder/complete" ] && exit 0

mkdir -p "$folder"
folder=$(cd "$folder" && pwd)
exec 9>"$folder/lock"
flock 9
[ -f "$folder/complete" ] && exit 0

die() {
    echo "fetch_kernel: $*" >&2
    echo "fetch_kernel: the guest needs Debian 12's package linux-image-6.1.*-amd64; run" \
        "'apt-get update' as root and see that 'apt-cache depends linux-image-amd64' names it" >&2
    exit 1
}

for tool in apt-get apt-cache dpkg-deb tar; do
    command -v "$tool" >/dev/null || die "there is no $tool here"
done
package=$(apt-cache depends linux-image-amd64 2>/dev/null |
    sed -n 's/^ *Depends: *\(linux-image-6\.1\.[0-9-]*-amd64\)$/\1/p' | head -n 1)
if [ -z "$package" ]; then
    package=$(apt-cache pkgnames linux-image-6.1. 2>/dev/null |
        grep -E '^linux-image-6\.1\.[0-9]+-[0-9]+-amd64$' | sort -V | tail -n 1) || true
fi
[ -n "$package" ] || die "apt knows no such package"

rm -rf "$folder/part"
mkdir "$folder/part"
(cd "$folder/part" && apt-get -q download "$package") || die "cannot download $package"
set -- "$folder"/part/*.deb
[ -f "$1" ] || die "$package left no file"

# Of 400 MB of modules only the folders that the guest's can come from.
dpkg-deb --fsys-tarfile "$1" | tar -x -C "$folder/part" --wildcards \
    './boot/vmlinuz-*' './lib/modules/*/kernel/fs/*' './lib/modules/*/kernel/lib/*' \
    './lib/modules/*/kernel/net/9p/*' './lib/modules/*/kernel/drivers/usb/*' \
    './lib/modules/*/kernel/drivers/media/*' './lib/modules/*/kernel/drivers/virtio/*' ||
    die "cannot unpack $package"
rm -rf "$folder/modules" "$folder/vmlinuz"
mv "$folder"/part/boot/vmlinuz-* "$folder/vmlinuz"
mv "$folder"/part/lib/modules/*/kernel "$folder/modules"
rm -rf "$folder/part"
echo "$package" >"$folder/complete"
