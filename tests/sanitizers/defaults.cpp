// Options of the sanitizers, linked into every program that is built with one: what they would otherwise
// report is other libraries' own. Names and signatures are the sanitizers' interface.
extern "C" {

const char* __lsan_default_suppressions() {
    return "leak:libomp.so\n"     // thread descriptors, kept until the process ends
           "leak:libfontconfig";  // fonts that cairo looked up, likewise
}

const char* __tsan_default_options() {
    // libomp is not instrumented; its tool archer, loaded by itself, tells the sanitizer about OpenMP's
    // barriers
    return "ignore_noninstrumented_modules=1 halt_on_error=1";
}

}  // extern "C"
