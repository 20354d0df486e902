#pragma once

namespace cartvo {

// The self-contained files of the page that LivePage serves.

extern const char* const kLivePageHtml;
extern const char* const kLivePageScript;

}  // namespace cartvo
