#!/bin/bash
# boot_guest.sh FOLDER SECONDS PROGRAM [ARGUMENT...]: boots the guest and runs PROGRAM of the host in it.
#
# FOLDER keeps the kernel (kernel/), and of this run share/output (what PROGRAM printed),
# share/status and console.log. Ends with PROGRAM's status; with 125 if the guest did not run it to
# its end, and says why.
set -u
here=$(cd "$(dirname "$(readlink -f "$0")")" && pwd)
folder=$1
seconds=$2
shift 2

mkdir -p "$folder" && folder=$(cd "$folder" && pwd) || exit 125
share=$folder/share
rm -rf "$share" "$folder/console.log"
mkdir -p "$share"

die() { echo "boot_guest: $*" >&2; exit 125; }

command -v qemu-system-x86_64 >/dev/null || die "there is no qemu-system-x86_64 (package qemu-system-x86)"
sh "$here/fetch_kernel.sh" "$folder/kernel" || die "no kernel for the guest"
sh "$here/make_initramfs.sh" "$folder/kernel" "$here/init" "$folder/initramfs" || die "no initramfs"
{ printf 'exec'; printf ' %q' "$@"; echo; } >"$share/command"

# KVM is not asked for: where it is offered in a nested machine it may hang. A comma in an option's
# value is written twice.
timeout --kill-after=5 "$seconds" qemu-system-x86_64 \
    -accel tcg,thread=multi -cpu max -smp 2 -m 1024 -nic none -display none -monitor none \
    -no-reboot -chardev "file,id=console,path=${folder//,/,,}/console.log" -serial chardev:console \
    -kernel "$folder/kernel/vmlinuz" -initrd "$folder/initramfs" \
    -append 'console=ttyS0 quiet loglevel=4 panic=-1 rdinit=/init mitigations=off tsc=reliable' \
    -fsdev 'local,id=host,path=/,security_model=none,readonly=on,multidevs=remap' \
    -device virtio-9p-pci,fsdev=host,mount_tag=host \
    -fsdev "local,id=share,path=${share//,/,,},security_model=none" \
    -device virtio-9p-pci,fsdev=share,mount_tag=share </dev/null
status=$?
if [ ! -f "$share/status" ]; then
    tail -n 40 "$folder/console.log" >&2 2>/dev/null
    [ $status = 124 ] && die "the guest was not done after $seconds s"
    die "the guest stopped early (QEMU's status $status)"
fi
exit "$(cat "$share/status")"
