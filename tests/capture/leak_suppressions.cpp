// What the libraries behind the tests' own encoders and servers leave behind is not ours to mend.

extern "C" const char* __lsan_default_suppressions();  // NOLINT(bugprone-reserved-identifier)

extern "C" const char* __lsan_default_suppressions() {  // NOLINT(bugprone-reserved-identifier)
  return "leak:libx265\nleak:libglib-2.0\n";
}
