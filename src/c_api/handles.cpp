// SPDX-License-Identifier: Apache-2.0
#include "c_api/handles.h"

#include <array>

namespace fasttree::c_api {
namespace {

// Of fixed size, so that reporting needs no memory, least of all when there is none.
thread_local std::array<char, 1024> last_error{};

}  // namespace

ft_status finish(const Status& status) {
  if (!status.ok()) {
    const std::size_t length = std::min(status.message().size(), last_error.size() - 1);
    std::memcpy(last_error.data(), status.message().data(), length);
    last_error[length] = '\0';
  }
  return static_cast<ft_status>(status.code());
}

Status read_mesh(const char* call, const ft_mesh* from, MeshView& to) {
  ft_mesh mesh;
  if (Status s = read_struct(call, "mesh", from, mesh); !s.ok()) return s;
  to.positions = mesh.positions;
  to.position_stride_bytes = mesh.position_stride_bytes;
  to.vertex_count = mesh.vertex_count;
  to.indices = mesh.indices;
  to.triangle_count = mesh.triangle_count;
  return {};
}

}  // namespace fasttree::c_api

using namespace fasttree;

const char* ft_version(void) {
  return FASTTREE_VERSION;
}

const char* ft_last_error(void) {
  return c_api::last_error.data();
}

const char* ft_status_name(uint32_t status) {
  switch (static_cast<StatusCode>(status)) {
    case StatusCode::ok:
      return "ok";
    case StatusCode::invalid_argument:
      return "invalid argument";
    case StatusCode::bad_input:
      return "bad input";
    case StatusCode::resource_limit:
      return "resource limit";
    case StatusCode::cancelled:
      return "cancelled";
    case StatusCode::io_error:
      return "i/o error";
  }
  return "unknown status";
}
