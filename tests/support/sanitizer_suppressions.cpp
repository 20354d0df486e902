// What the sanitizers cannot see into: the libraries behind the tests' encoders and servers, and behind the
// letters of printed boards (cairo's fontconfig keeps its patterns for ever).

// NOLINTBEGIN(readability-identifier-naming)
extern "C" const char* __lsan_default_suppressions();
extern "C" const char* __tsan_default_suppressions();

extern "C" const char* __lsan_default_suppressions() {
  return "leak:libx265\nleak:libglib-2.0\nleak:libfontconfig\n";
}

// GStreamer and GLib are not instrumented, so what they hand from thread to thread looks like a race;
// client_feeds frees what came through them.
extern "C" const char* __tsan_default_suppressions() {
  return "race:libglib-2.0\nrace:libgio-2.0\nrace:libgobject-2.0\nrace:libgst\nrace:client_feeds.cpp\n";
}
// NOLINTEND(readability-identifier-naming)
