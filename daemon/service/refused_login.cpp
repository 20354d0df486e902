// Asks a camera why it refused a login.
#include "daemon/service/refused_login.hpp"

#include <exception>

#include "capture/isapi/isapi_client.hpp"

namespace cartvo::daemon {

capture::RefusedLogin askAboutRefusedLogin(const capture::HttpAddress& address,
                                           std::chrono::milliseconds timeout,
                                           const std::atomic<bool>& interrupted) {
  try {
    capture::IsapiSettings settings;
    settings.address = address;
    settings.timeout = timeout;
    capture::IsapiClient client(settings);
    client.setInterruption(interrupted);
    const capture::LoginState state = client.loginState();
    return {state.unlock_after, capture::loginStateText(state)};
  } catch (const std::exception&) {
    return {};  // other makers' cameras, and those that serve only HTTPS
  }
}

}  // namespace cartvo::daemon
