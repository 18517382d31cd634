// SPDX-License-Identifier: MIT
// Linked into sanitizer builds of tests that draw: keeps the checkers to our own faults.

int dlclose(void* handle);
const char* __lsan_default_suppressions(void);
const char* __tsan_default_suppressions(void);

// Drivers are unloaded before the checker looks, and what they hold would then count as lost.
int dlclose(void* handle)
{
    (void)handle;
    return 0;
}

// OSMesa never frees the drawable of a context that is destroyed.
const char* __lsan_default_suppressions(void)
{
    return "leak:libOSMesa.so\n";
}

// Drivers are not instrumented: their atomic reference counts are not seen.
const char* __tsan_default_suppressions(void)
{
    return "race:libOSMesa.so\nrace:swrast_dri.so\n";
}
