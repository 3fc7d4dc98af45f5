#!/bin/sh
# make_initramfs.sh KERNEL_FOLDER INIT OUT: busybox, the guest's modules and INIT as a cpio archive.
#
# /modules/boot holds, in the order in which they must be inserted, what reaches the host's files
# and the virtual USB bus; /modules/later what scenarios insert themselves with parameters.
set -eu
kernel=$1
init=$2
out=$3

die() { echo "make_initramfs: $*" >&2; exit 1; }

busybox=$(command -v busybox) || die "there is no busybox here (package busybox-static)"
if ldd "$busybox" >/dev/null 2>&1; then
    die "$busybox is not static (package busybox-static)"
fi

root=$(mktemp -d "$out.XXXXXX")
trap 'rm -rf "$root"' EXIT
mkdir -p "$root/bin" "$root/proc" "$root/sys" "$root/dev" "$root/host" "$root/share" "$root/new" \
    "$root/modules/boot" "$root/modules/later"
cp "$busybox" "$root/bin/busybox"
cp "$init" "$root/init"
chmod 755 "$root/init" "$root/bin/busybox"

placed=' '
count=100
# place STAGE MODULE: its dependencies first, each once. A module's file may use - for _.
place() {
    case $placed in *" $2 "*) return 0 ;; esac
    placed="$placed$2 "
    pattern=$(echo "$2" | sed 's/[-_]/[-_]/g')
    file=$(find "$kernel/modules" -name "$pattern.ko" | head -n 1)
    [ -n "$file" ] || die "the kernel package has no module $2"
    for needed in $(tr '\0' '\n' <"$file" | sed -n 's/^depends=//p' | tr '-' '_' | tr ',' ' '); do
        place "$1" "$needed"
    done
    # The recursion above has overwritten the variables.
    pattern=$(echo "$2" | sed 's/[-_]/[-_]/g')
    count=$((count + 1))
    cp "$(find "$kernel/modules" -name "$pattern.ko" | head -n 1)" \
        "$root/modules/$1/$count-$2.ko"
}
for module in virtio_pci 9pnet_virtio 9p vhci_hcd; do place boot "$module"; done
for module in gspca_kinect vivid uvcvideo; do place later "$module"; done

(cd "$root" && find . | "$busybox" cpio -o -H newc 2>/dev/null) >"$out.part"
mv "$out.part" "$out"
