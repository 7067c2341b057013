// SPDX-License-Identifier: Apache-2.0
#include "live/window.h"

namespace fasttree::live {

Result<std::unique_ptr<Window>> open_window(const std::string&, std::uint32_t, std::uint32_t) {
  return Status(StatusCode::invalid_argument,
                "this program was built without a window; install the package libsdl2-dev and "
                "build it again");
}

}  // namespace fasttree::live
