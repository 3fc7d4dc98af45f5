// Part of the program in AddressSanitizer builds only. What a Vulkan driver keeps for itself cannot
// be told from our own leaks once the loader has unloaded the driver: the addresses then belong to
// no module, and no suppression fits. So nothing is unloaded.
extern "C" int dlclose(void* handle) noexcept;
extern "C" int dlclose(void*) noexcept {
    return 0;
}
