"""Programs for 64-bit ARM: what compiles them, and what runs them here."""
import shutil

GCC = "aarch64-linux-gnu-gcc"


def emulator():
    """None: there is no compiler for them, or nothing that runs them."""
    return shutil.which(GCC) and (shutil.which("qemu-aarch64") or shutil.which("qemu-aarch64-static"))
