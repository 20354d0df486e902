#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

namespace httplib {
class Server;
struct Request;
struct Response;
}  // namespace httplib

// ISAPI of a camera over real HTTP on loopback, with the habits of several firmwares.

namespace cartvo::test {

/// Documents by path, as XML.
using IsapiDocuments = std::map<std::string, std::string>;

/// Documents of a camera as it comes out of the box: much is set as odometry does not want it.
/// `root_attributes`: attributes of each root element, such as a namespace.
IsapiDocuments factoryDocuments(const std::string& root_attributes =
                                    "version=\"2.0\" xmlns=\"http://www.hikvision.com/ver20/XMLSchema\"");

/// The documents with another serial number.
IsapiDocuments withSerialNumber(IsapiDocuments documents, const std::string& serial_number);

/// The factory's documents with a prefix on each element, blanks around all values, and without what only
/// newer firmwares have.
IsapiDocuments oldFirmwareDocuments();

/// How a camera behaves.
struct CameraHabits {
  std::string user = "admin", password = "camera-password";
  std::vector<std::string> algorithms{"MD5"};  ///< offered, in this order
  bool takes_whole_documents = true;           ///< else PUT of a whole document is forbidden (notSupport)
  bool takes_parts = true;                     ///< else PUT of a sub-resource is not found
  bool refuses_incomplete = true;              ///< PUT of a document without all of its elements gives 500
  bool ignores_image_changes = false;          ///< PUT of the whole image is accepted without effect
  bool wants_reboot = false;                   ///< each change takes effect only after one
  bool is_locked = false, is_activated = true, knows_user_check = true;
  bool may_write = true;      ///< else PUT is forbidden (lowPrivilege)
  int puts_left = -1;         ///< PUT is forbidden after so many; -1: no limit
  int booting_answers = 0;    ///< so many requests get 500 first
  int busy_answers = 0;       ///< so many requests with a password get "busy" first
  int nonce_uses = 0;         ///< requests until a nonce is stale; 0: no limit
  bool says_stale = true;     ///< else a dead nonce is refused like a wrong password
  bool always_stale = false;  ///< a wrong password is called a dead nonce
  bool tls = false;
};

/// The camera. Runs in a thread of its own until it is destroyed.
class IsapiServer {
 public:
  /// `port`: 0 chooses a free one. The left and the right camera of a test are two hosts with one port.
  explicit IsapiServer(CameraHabits habits = {}, IsapiDocuments documents = factoryDocuments(),
                       const std::string& host = "127.0.0.1", int port = 0);
  ~IsapiServer();
  IsapiServer(const IsapiServer&) = delete;
  IsapiServer& operator=(const IsapiServer&) = delete;

  int port() const { return port_; }

  /// The document at a path now.
  std::string document(const std::string& path) const;

  /// "GET /ISAPI/System/time" of all requests so far that passed authentication, and of userCheck.
  std::vector<std::string> requests() const;
  int wrongPasswords() const;
  /// Most requests that were served at one time.
  int mostAtOnce() const;
  /// All that the client has sent: request lines, headers and bodies.
  std::string received() const;

  /// All nonces die, as at a reboot.
  void forgetNonces();
  /// Changes how it behaves from now on.
  void setHabits(const CameraHabits& habits);

 private:
  void serve(const httplib::Request& request, httplib::Response& response);
  bool authenticate(const httplib::Request& request, httplib::Response& response);
  void challenge(httplib::Response& response, bool stale);
  void answer(const httplib::Request& request, httplib::Response& response);
  void put(const httplib::Request& request, httplib::Response& response);
  bool putPart(const httplib::Request& request, httplib::Response& response);
  std::string userCheck(int status) const;

  mutable std::mutex mutex_;
  CameraHabits habits_;
  IsapiDocuments documents_;
  std::vector<std::string> requests_;
  std::map<std::string, int> nonces_;  ///< uses
  std::string received_;
  int next_nonce_ = 1, wrong_passwords_ = 0, at_once_ = 0, most_at_once_ = 0;
  std::unique_ptr<httplib::Server> server_;
  int port_ = 0;
  std::thread thread_;
};

}  // namespace cartvo::test
