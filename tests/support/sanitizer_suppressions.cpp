// Suppressions of sanitizer findings in uninstrumented libraries: those of the test encoders and servers, and
// fontconfig, which cairo uses for the text of printed boards and which never frees its patterns.

// NOLINTBEGIN(readability-identifier-naming)
extern "C" const char* __lsan_default_suppressions();
extern "C" const char* __tsan_default_suppressions();

extern "C" const char* __lsan_default_suppressions() {
  return "leak:libx265\nleak:libglib-2.0\nleak:libfontconfig\n";
}

// GStreamer and GLib are not instrumented, so data that they pass between threads looks like a race;
// client_feeds frees such data.
extern "C" const char* __tsan_default_suppressions() {
  return "race:libglib-2.0\nrace:libgio-2.0\nrace:libgobject-2.0\nrace:libgst\nrace:client_feeds.cpp\n";
}
// NOLINTEND(readability-identifier-naming)
