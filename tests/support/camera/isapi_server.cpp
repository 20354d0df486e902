// ISAPI of a camera over real HTTP on loopback.
#include "support/camera/isapi_server.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <regex>
#include <set>
#include <sstream>
#include <stdexcept>

#include <httplib.h>
#include <openssl/evp.h>
#include <openssl/rsa.h>
#include <openssl/x509.h>
#include <pugixml.hpp>

namespace cartvo::test {
namespace {

std::string hexDigest(const std::string& algorithm, const std::string& text) {
  std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
  unsigned int size = 0;
  EVP_Digest(text.data(), text.size(), digest.data(), &size, algorithm == "MD5" ? EVP_md5() : EVP_sha256(),
             nullptr);
  std::string hex;
  for (unsigned int i = 0; i < size; ++i) {
    constexpr std::string_view kDigits = "0123456789abcdef";
    hex += kDigits[digest[i] >> 4U];
    hex += kDigits[digest[i] & 15U];
  }
  return hex;
}

/// The parameters of a Digest Authorization header.
std::map<std::string, std::string> parametersOf(const std::string& header) {
  std::map<std::string, std::string> parameters;
  const std::regex parameter("(\\w+)=(\"([^\"]*)\"|[^,\\s]+)");
  for (std::sregex_iterator it(header.begin(), header.end(), parameter), end; it != end; ++it)
    parameters[(*it)[1]] = (*it)[3].matched ? (*it)[3].str() : (*it)[2].str();
  return parameters;
}

std::string status(int code, const std::string& text, const std::string& sub_code) {
  return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<ResponseStatus version=\"2.0\" "
         "xmlns=\"http://www.hikvision.com/ver20/XMLSchema\"><requestURL></requestURL><statusCode>" +
         std::to_string(code) + "</statusCode><statusString>" + text + "</statusString><subStatusCode>" +
         sub_code + "</subStatusCode></ResponseStatus>\n";
}

void respond(httplib::Response& response, int http, const std::string& body) {
  response.status = http;
  response.set_content(body, "application/xml");
}

std::string localName(const pugi::xml_node& node) {
  const std::string name = node.name();
  return name.substr(name.find(':') + 1);
}

std::set<std::string> elementNames(const pugi::xml_node& root) {
  std::set<std::string> names;
  for (const pugi::xml_node& child : root.children())
    names.insert(child.name());
  return names;
}

/// A certificate that the server signs itself, and its key.
std::pair<X509*, EVP_PKEY*> selfSigned() {
  EVP_PKEY* key = EVP_RSA_gen(2048);
  X509* certificate = X509_new();
  ASN1_INTEGER_set(X509_get_serialNumber(certificate), 1);
  X509_gmtime_adj(X509_getm_notBefore(certificate), 0);
  X509_gmtime_adj(X509_getm_notAfter(certificate), 3600);
  X509_set_pubkey(certificate, key);
  X509_NAME* name = X509_get_subject_name(certificate);
  X509_NAME_add_entry_by_txt(name, "CN", MBSTRING_ASC, reinterpret_cast<const unsigned char*>("camera"), -1,
                             -1, 0);
  X509_set_issuer_name(certificate, name);
  X509_sign(certificate, key, EVP_sha256());
  return {certificate, key};
}

std::unique_ptr<httplib::Server> makeServer(bool tls) {
  if (!tls) return std::make_unique<httplib::Server>();
  const auto [certificate, key] = selfSigned();
  auto server = std::make_unique<httplib::SSLServer>(certificate, key);
  X509_free(certificate);
  EVP_PKEY_free(key);
  return server;
}

}  // namespace

IsapiServer::IsapiServer(CameraHabits habits, IsapiDocuments documents, const std::string& host, int port)
    : habits_(std::move(habits)), documents_(std::move(documents)), server_(makeServer(habits_.tls)) {
  const auto handler = [this](const httplib::Request& request, httplib::Response& response) {
    serve(request, response);
  };
  server_->set_tcp_nodelay(true);
  server_->set_keep_alive_timeout(1);
  server_->set_read_timeout(1);
  server_->Get(".*", handler);
  server_->Put(".*", handler);
  port_ = port == 0 ? server_->bind_to_any_port(host) : port;
  if (port_ < 0 || (port > 0 && !server_->bind_to_port(host, port)))
    throw std::runtime_error("IsapiServer: cannot bind a port on " + host);
  thread_ = std::thread([this] { server_->listen_after_bind(); });
  while (!server_->is_running())
    std::this_thread::yield();
}

IsapiServer::~IsapiServer() {
  server_->stop();
  thread_.join();
}

std::string IsapiServer::document(const std::string& path) const {
  const std::lock_guard lock(mutex_);
  return documents_.at(path);
}
std::vector<std::string> IsapiServer::requests() const {
  const std::lock_guard lock(mutex_);
  return requests_;
}
int IsapiServer::wrongPasswords() const {
  const std::lock_guard lock(mutex_);
  return wrong_passwords_;
}
int IsapiServer::mostAtOnce() const {
  const std::lock_guard lock(mutex_);
  return most_at_once_;
}
std::string IsapiServer::received() const {
  const std::lock_guard lock(mutex_);
  return received_;
}
void IsapiServer::forgetNonces() {
  const std::lock_guard lock(mutex_);
  nonces_.clear();
}
void IsapiServer::setHabits(const CameraHabits& habits) {
  const std::lock_guard lock(mutex_);
  habits_ = habits;
}

std::string IsapiServer::userCheck(int http) const {
  std::ostringstream text;
  text
      << "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<userCheck version=\"2.0\" "
         "xmlns=\"http://www.isapi.org/ver20/XMLSchema\"><statusValue>"
      << http
      << "</statusValue><statusString>Unauthorized</statusString><isDefaultPassword>false</isDefaultPassword>"
      << "<isActivated>" << (habits_.is_activated ? "true" : "false") << "</isActivated><lockStatus>"
      << (habits_.is_locked ? "lock" : "unlock") << "</lockStatus>";
  if (habits_.is_locked)
    text << "<unlockTime>1799</unlockTime>";
  else
    text << "<retryLoginTime>" << 5 - wrong_passwords_ << "</retryLoginTime>";
  text << "</userCheck>\n";
  return text.str();
}

void IsapiServer::challenge(httplib::Response& response, bool stale) {
  const std::string nonce = "nonce" + std::to_string(next_nonce_++);
  nonces_[nonce] = 0;
  response.status = 401;
  for (const std::string& algorithm : habits_.algorithms)
    response.headers.emplace("WWW-Authenticate", "Digest realm=\"IP Camera\", qop=\"auth\", nonce=\"" +
                                                     nonce + "\", algorithm=" + algorithm +
                                                     (stale ? ", stale=true" : ""));
  response.headers.emplace("WWW-Authenticate", "Basic realm=\"IP Camera\"");
  response.set_content(userCheck(401), "application/xml");
}

bool IsapiServer::authenticate(const httplib::Request& request, httplib::Response& response) {
  std::map<std::string, std::string> given = parametersOf(request.get_header_value("Authorization"));
  if (given.empty()) {
    challenge(response, false);
    return false;
  }
  const auto nonce = nonces_.find(given["nonce"]);
  const bool is_dead =
      nonce == nonces_.end() || (habits_.nonce_uses > 0 && nonce->second >= habits_.nonce_uses);
  if (is_dead) {
    if (nonce != nonces_.end()) nonces_.erase(nonce);
    challenge(response, habits_.says_stale);
    return false;
  }
  ++nonce->second;
  const std::string algorithm = given.count("algorithm") > 0 ? given["algorithm"] : "MD5";
  const std::string a1 = hexDigest(algorithm, given["username"] + ":IP Camera:" + habits_.password);
  const std::string a2 = hexDigest(algorithm, request.method + ":" + given["uri"]);
  const std::string expected = hexDigest(algorithm, a1 + ":" + given["nonce"] + ":" + given["nc"] + ":" +
                                                        given["cnonce"] + ":" + given["qop"] + ":" + a2);
  if (given["response"] == expected && given["uri"] == request.path && given["username"] == habits_.user)
    return true;
  ++wrong_passwords_;
  habits_.is_locked = habits_.is_locked || wrong_passwords_ >= 5;
  challenge(response, habits_.always_stale);
  return false;
}

void IsapiServer::serve(const httplib::Request& request, httplib::Response& response) {
  {
    const std::lock_guard lock(mutex_);
    most_at_once_ = std::max(most_at_once_, ++at_once_);
    received_ += request.method + " " + request.path + "\n" + request.body;
    for (const auto& [name, value] : request.headers)
      received_ += name + ": " + value + "\n";
  }
  const std::lock_guard lock(mutex_);
  answer(request, response);
  --at_once_;
}

void IsapiServer::answer(const httplib::Request& request, httplib::Response& response) {
  if (habits_.booting_answers > 0) {
    --habits_.booting_answers;
    return respond(response, 500, "<html><body>starting</body></html>");
  }
  if (request.path == "/ISAPI/Security/userCheck" && !request.has_header("Authorization")) {
    requests_.push_back(request.method + " " + request.path);
    if (habits_.knows_user_check) return respond(response, 401, userCheck(401));
    return respond(response, 404, status(4, "Invalid Operation", "notSupport"));
  }
  if (!authenticate(request, response)) return;
  requests_.push_back(request.method + " " + request.path);
  if (habits_.busy_answers > 0) {
    --habits_.busy_answers;
    return respond(response, 503, status(2, "Device Busy", "deviceBusy"));
  }
  if (request.method == "PUT") return put(request, response);
  const auto found = documents_.find(request.path);
  if (found == documents_.end()) return respond(response, 403, status(4, "Invalid Operation", "notSupport"));
  respond(response, 200, found->second);
}

void IsapiServer::put(const httplib::Request& request, httplib::Response& response) {
  const std::string done =
      habits_.wants_reboot ? status(7, "Reboot Required", "rebootRequired") : status(1, "OK", "ok");
  if (!habits_.may_write || habits_.puts_left == 0)
    return respond(response, 403, status(4, "Invalid Operation", "lowPrivilege"));
  if (habits_.puts_left > 0) --habits_.puts_left;
  if (request.path == "/ISAPI/System/reboot") {
    nonces_.clear();
    habits_.booting_answers = 2;
    return respond(response, 200, status(1, "OK", "ok"));
  }
  const auto found = documents_.find(request.path);
  if (found == documents_.end()) {
    if (habits_.takes_parts && putPart(request, response)) return respond(response, 200, done);
    if (response.status < 400) respond(response, 404, status(4, "Invalid Operation", "notSupport"));
    return;
  }
  if (const bool has_parts = request.path != "/ISAPI/System/time";
      has_parts && !habits_.takes_whole_documents)
    return respond(response, 403, status(4, "Invalid Operation", "notSupport"));
  pugi::xml_document old_document, new_document;
  old_document.load_string(found->second.c_str());
  if (!new_document.load_string(request.body.c_str()))
    return respond(response, 400, status(5, "Invalid XML Format", "badXmlFormat"));
  const pugi::xml_node old_root = old_document.document_element(), new_root = new_document.document_element();
  const bool same_root =
      std::string(old_root.name()) == new_root.name() &&
      std::string(old_root.attribute("xmlns").value()) == new_root.attribute("xmlns").value();
  if (!same_root) return respond(response, 400, status(6, "Invalid XML Content", "badXmlContent"));
  if (habits_.refuses_incomplete && elementNames(old_root) != elementNames(new_root))
    return respond(response, 500, status(3, "Device Error", "deviceError"));
  const bool is_ignored = habits_.ignores_image_changes && request.path.find("/Image/") != std::string::npos;
  if (!is_ignored) found->second = request.body;
  respond(response, 200, done);
}

/// Replaces an element of a document; the last part of the path is its name in any case, or its id.
bool IsapiServer::putPart(const httplib::Request& request, httplib::Response& response) {
  const std::size_t slash = request.path.rfind('/');
  const auto found = documents_.find(request.path.substr(0, slash));
  pugi::xml_document document, part;
  if (found == documents_.end() || !document.load_string(found->second.c_str()) ||
      !part.load_string(request.body.c_str()))
    return false;
  const std::string name = request.path.substr(slash + 1);
  for (pugi::xml_node child : document.document_element().children()) {
    // These firmwares spell addresses with a small first letter.
    std::string address = localName(child);
    address.front() = static_cast<char>(std::tolower(static_cast<unsigned char>(address.front())));
    if (name == "text" && localName(child) == "TextOverlayList") address = name;
    if (address != name && child.child("id").text().get() != name) continue;
    if (localName(child) != localName(part.document_element())) {
      respond(response, 400, status(6, "Invalid XML Content", "badXmlContent"));
      return false;
    }
    document.document_element().insert_copy_after(part.document_element(), child);
    document.document_element().remove_child(child);
    std::ostringstream text;
    document.print(text, "", pugi::format_raw);
    found->second = text.str();
    return true;
  }
  return false;
}

}  // namespace cartvo::test
