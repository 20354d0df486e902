// Ctrl-C during long work that writes files.
#include "tools/cartvo/interruption.hpp"

#include <cstdio>

#include "common/command_line/command_line_error.hpp"

namespace cartvo {
namespace {

volatile std::sig_atomic_t received_signal = 0;

void note(int signal) {
  received_signal = signal;
}

/// An ignored signal stays ignored, as SIGHUP under nohup and SIGINT of a job in the background.
void replaceAction(int signal, struct sigaction& before) {
  sigaction(signal, nullptr, &before);
  if (before.sa_handler == SIG_IGN) return;
  struct sigaction action {};
  action.sa_handler = note;
  action.sa_flags = static_cast<int>(SA_RESETHAND);  // the second signal ends the program
  sigaction(signal, &action, nullptr);
}

}  // namespace

Interruption::Interruption() {
  received_signal = 0;
  replaceAction(SIGINT, interrupt_);
  replaceAction(SIGTERM, terminate_);
  replaceAction(SIGHUP, hang_up_);
}

Interruption::~Interruption() {
  sigaction(SIGINT, &interrupt_, nullptr);
  sigaction(SIGTERM, &terminate_, nullptr);
  sigaction(SIGHUP, &hang_up_, nullptr);
}

void Interruption::check() const {
  if (received() == 0) return;
  constexpr int kSignalBase = 128;  // as shells report a program that a signal ended
  std::fputs("\ncartvo: interrupted; nothing was written\n", stderr);
  throw ExitCode(kSignalBase + received());
}

int Interruption::received() const {
  return received_signal;
}

}  // namespace cartvo
