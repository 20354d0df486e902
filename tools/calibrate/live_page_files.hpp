#pragma once

namespace cartvo {

// The files of the page that LivePage serves. They need nothing from elsewhere.

extern const char* const kLivePageHtml;
extern const char* const kLivePageScript;

}  // namespace cartvo
