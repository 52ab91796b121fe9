// What the sanitizers are told when they are on: both the tests and the program link it then.
//
// Graphics drivers (and x264, of its parameters) keep a little for good, and unload before leaks are looked
// for; a leak in an unloaded library has no name that could be let pass. So libraries stay loaded, and what
// theirs is, is passed over in silence: the program's own standard error is part of what tests read.
extern "C" {
const char* __lsan_default_suppressions();
const char* __lsan_default_suppressions() {
  return "leak:libOSMesa.so\nleak:libGL\nleak:libEGL\nleak:_dri.so\nleak:libX11\nleak:libgallium\n"
         "leak:libx264\n";
}

const char* __lsan_default_options();
const char* __lsan_default_options() { return "print_suppressions=0"; }

// What is freed is held back for a while to be watched; tests that look at how much memory stays want it
// short.
const char* __asan_default_options();
const char* __asan_default_options() { return "quarantine_size_mb=8"; }

int dlclose(void* handle);
int dlclose(void* /*handle*/) { return 0; }
}
