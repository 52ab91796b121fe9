// What the leak sanitizer passes over in tests: Mesa keeps about a hundred bytes of each OSMesa context for
// itself.
extern "C" const char* __lsan_default_suppressions();
extern "C" const char* __lsan_default_suppressions() { return "leak:libOSMesa.so\n"; }
