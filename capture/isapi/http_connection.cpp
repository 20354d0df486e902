// HTTP and HTTPS to a camera, on libcurl.
#include "capture/isapi/http_connection.hpp"

#include <array>
#include <string_view>
#include <utility>

#include <curl/curl.h>
#include <openssl/evp.h>
#include <openssl/pem.h>
#include <openssl/x509.h>

#include "common/ascii_text.hpp"
#include "common/base64.hpp"

namespace cartvo::capture {
namespace {

struct ListDeleter {
  void operator()(curl_slist* list) const { curl_slist_free_all(list); }
};
using HeaderList = std::unique_ptr<curl_slist, ListDeleter>;

HeaderList headerList(const HttpRequest& request) {
  curl_slist* list = nullptr;
  for (const std::string& header : request.headers)
    list = curl_slist_append(list, header.c_str());
  // Cameras with a simple server do not answer "Expect: 100-continue".
  list = curl_slist_append(list, "Expect:");
  if (!request.body.empty()) list = curl_slist_append(list, "Content-Type: application/xml");
  return HeaderList(list);
}

std::size_t takeBody(const char* data, std::size_t size, std::size_t count, void* user) {
  auto& body = *static_cast<std::string*>(user);
  if (body.size() + size * count > kMaxResponseBytes) return 0;
  body.append(data, size * count);
  return size * count;
}

std::size_t takeHeader(const char* data, std::size_t size, std::size_t count, void* user) {
  constexpr std::string_view kName = "www-authenticate:";
  constexpr std::size_t kMaxChallenges = 16;
  auto& challenges = *static_cast<std::vector<std::string>*>(user);
  const std::string_view line(data, size * count);
  if (line.starts_with("HTTP/")) challenges.clear();
  if (line.size() > kName.size() && lowerCase(line.substr(0, kName.size())) == kName &&
      challenges.size() < kMaxChallenges)
    challenges.emplace_back(trimmed(line.substr(kName.size())));
  return size * count;
}

int checkInterruption(void* user, curl_off_t /*total*/, curl_off_t /*now*/, curl_off_t /*up_total*/,
                      curl_off_t /*up_now*/) {
  return static_cast<const std::atomic<bool>*>(user)->load() ? 1 : 0;
}

/// RFC 7469, 2.4, of a certificate in PEM; empty if it cannot be read.
std::string keyOf(const std::string& certificate) {
  const std::unique_ptr<BIO, decltype(&BIO_free)> input(
      BIO_new_mem_buf(certificate.data(), static_cast<int>(certificate.size())), BIO_free);
  const std::unique_ptr<X509, decltype(&X509_free)> x509(
      PEM_read_bio_X509(input.get(), nullptr, nullptr, nullptr), X509_free);
  if (!x509) return {};
  unsigned char* der = nullptr;
  const int size = i2d_X509_PUBKEY(X509_get_X509_PUBKEY(x509.get()), &der);
  if (size <= 0) return {};
  std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
  unsigned int digest_size = 0;
  EVP_Digest(der, static_cast<std::size_t>(size), digest.data(), &digest_size, EVP_sha256(), nullptr);
  OPENSSL_free(der);
  return "sha256//" + encodeBase64({reinterpret_cast<const char*>(digest.data()), digest_size});
}

void initialiseCurl() {
  static const CURLcode kDone = curl_global_init(CURL_GLOBAL_DEFAULT);
  if (kDone != CURLE_OK) throw std::runtime_error("libcurl cannot be initialised");
}

}  // namespace

std::string HttpAddress::url() const {
  std::string name = host;
  const bool is_ipv6 = host.find(':') != std::string::npos;
  if (const std::size_t zone = name.find('%'); is_ipv6 && zone != std::string::npos)
    name.insert(zone + 1, "25");  // RFC 6874
  return (tls ? "https://" : "http://") + (is_ipv6 ? "[" + name + "]" : name) + ":" + std::to_string(port);
}

struct HttpConnection::Handle {
  CURL* curl = curl_easy_init();
  const std::atomic<bool>* interrupted = nullptr;

  Handle() {
    if (curl == nullptr) throw std::runtime_error("libcurl has no memory");
  }
  ~Handle() { curl_easy_cleanup(curl); }
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;

  /// Options of every transfer. Options that were set before are forgotten, open connections are not.
  void reset(const std::string& url, std::chrono::milliseconds timeout) {
    curl_easy_reset(curl);
    curl_easy_setopt(curl, CURLOPT_URL, url.c_str());
    curl_easy_setopt(curl, CURLOPT_PROTOCOLS_STR, "http,https");
    curl_easy_setopt(curl, CURLOPT_PROXY, "");
    curl_easy_setopt(curl, CURLOPT_NOSIGNAL, 1L);
    curl_easy_setopt(curl, CURLOPT_QUICK_EXIT, 1L);  // else its end waits for a name server that is silent
    curl_easy_setopt(curl, CURLOPT_FOLLOWLOCATION, 0L);
    curl_easy_setopt(curl, CURLOPT_TIMEOUT_MS, static_cast<long>(timeout.count()));
    curl_easy_setopt(curl, CURLOPT_HTTP_VERSION, static_cast<long>(CURL_HTTP_VERSION_1_1));
    curl_easy_setopt(curl, CURLOPT_USERAGENT, "cartvo");
    // A camera signs its certificate itself; the key is compared instead (CURLOPT_PINNEDPUBLICKEY).
    curl_easy_setopt(curl, CURLOPT_SSL_VERIFYPEER, 0L);
    curl_easy_setopt(curl, CURLOPT_SSL_VERIFYHOST, 0L);
    if (interrupted == nullptr) return;
    curl_easy_setopt(curl, CURLOPT_NOPROGRESS, 0L);
    curl_easy_setopt(curl, CURLOPT_XFERINFOFUNCTION, checkInterruption);
    curl_easy_setopt(curl, CURLOPT_XFERINFODATA, const_cast<std::atomic<bool>*>(interrupted));
  }
};

HttpConnection::HttpConnection(HttpAddress address, std::chrono::milliseconds timeout)
    : address_(std::move(address)), timeout_(timeout) {
  initialiseCurl();
  handle_ = std::make_unique<Handle>();
}

HttpConnection::~HttpConnection() = default;

void HttpConnection::setInterruption(const std::atomic<bool>& interrupted) {
  handle_->interrupted = &interrupted;
}

void HttpConnection::setKey(const std::string& key) {
  key_ = key;
}

namespace {

HttpError errorOf(CURLcode code, const HttpAddress& address, std::chrono::milliseconds timeout) {
  const std::string camera = "the camera at " + address.url();
  switch (code) {
    case CURLE_SSL_PINNEDPUBKEYNOTMATCH:
      return {
          HttpError::Kind::wrong_key,
          camera +
              " has another key than the one that was kept of it: it is another device, or its certificate "
              "was made anew; no password was sent"};
    case CURLE_WRITE_ERROR:
      return {HttpError::Kind::too_large, camera + " answers with more than " +
                                              std::to_string(kMaxResponseBytes / 1024) +
                                              " KiB: is it a camera?"};
    case CURLE_ABORTED_BY_CALLBACK:
      return {HttpError::Kind::interrupted, "interrupted"};
    case CURLE_OPERATION_TIMEDOUT:
      return {HttpError::Kind::unreachable,
              camera + " did not answer within " + std::to_string(timeout.count()) + " ms"};
    case CURLE_SSL_CONNECT_ERROR:
      return {HttpError::Kind::unreachable, camera + " does not answer by TLS (" +
                                                std::string(curl_easy_strerror(code)) +
                                                "): switch HTTPS on in the camera, or leave --https out"};
    default:
      return {HttpError::Kind::unreachable, camera + " cannot be reached: " + curl_easy_strerror(code)};
  }
}

}  // namespace

std::string HttpConnection::fetchKey() {
  Handle handle;
  handle.interrupted = handle_->interrupted;
  handle.reset(address_.url(), timeout_);
  curl_easy_setopt(handle.curl, CURLOPT_CERTINFO, 1L);
  curl_easy_setopt(handle.curl, CURLOPT_CONNECT_ONLY, 1L);
  const CURLcode code = curl_easy_perform(handle.curl);
  if (code != CURLE_OK) throw errorOf(code, address_, timeout_);
  curl_certinfo* information = nullptr;
  curl_easy_getinfo(handle.curl, CURLINFO_CERTINFO, &information);
  constexpr std::string_view kCertificate = "Cert:";
  std::string key;
  if (information != nullptr && information->num_of_certs > 0) {
    for (const curl_slist* line = information->certinfo[0]; line != nullptr; line = line->next) {
      const std::string_view text = line->data;
      if (text.starts_with(kCertificate)) key = keyOf(std::string(text.substr(kCertificate.size())));
    }
  }
  if (key.empty())
    throw HttpError(HttpError::Kind::unreachable,
                    "the camera at " + address_.url() + " shows no certificate that can be read");
  return key;
}

HttpResponse HttpConnection::send(const HttpRequest& request) {
  if (address_.tls && key_.empty())
    throw std::logic_error("HttpConnection: no request without the key of the camera");
  const HeaderList headers = headerList(request);
  HttpResponse response;
  CURL* curl = handle_->curl;
  handle_->reset(address_.url() + request.path, timeout_);
  if (!key_.empty()) curl_easy_setopt(curl, CURLOPT_PINNEDPUBLICKEY, key_.c_str());
  curl_easy_setopt(curl, CURLOPT_HTTPHEADER, headers.get());
  curl_easy_setopt(curl, CURLOPT_WRITEFUNCTION, takeBody);
  curl_easy_setopt(curl, CURLOPT_WRITEDATA, &response.body);
  curl_easy_setopt(curl, CURLOPT_HEADERFUNCTION, takeHeader);
  curl_easy_setopt(curl, CURLOPT_HEADERDATA, &response.challenges);
  if (request.method != "GET") {
    curl_easy_setopt(curl, CURLOPT_CUSTOMREQUEST, request.method.c_str());
    curl_easy_setopt(curl, CURLOPT_POSTFIELDS, request.body.c_str());
    curl_easy_setopt(curl, CURLOPT_POSTFIELDSIZE, static_cast<long>(request.body.size()));
  }
  const CURLcode code = curl_easy_perform(curl);
  if (code != CURLE_OK) throw errorOf(code, address_, timeout_);
  long status = 0;
  curl_easy_getinfo(curl, CURLINFO_RESPONSE_CODE, &status);
  response.status = static_cast<int>(status);
  return response;
}

}  // namespace cartvo::capture
