// SPDX-License-Identifier: Apache-2.0
// What stands behind the C interface: its handles, its error text, and the border that no exception
// crosses.
#pragma once

#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <exception>
#include <memory>
#include <new>
#include <stdexcept>
#include <string>
#include <system_error>

#include "fasttree/build.h"
#include "fasttree/fasttree_c.h"
#include "fasttree/mesh.h"
#include "fasttree/status.h"
#include "fasttree/trace.h"
#include "fasttree/tree.h"

struct ft_builder {
  fasttree::Builder builder;
};

// Shared, because a tracer keeps the tree it was made for.
struct ft_tree {
  std::shared_ptr<fasttree::Tree> tree;
};

struct ft_tracer {
  std::shared_ptr<const fasttree::Tree> tree;
  fasttree::Tracer tracer;
};

namespace fasttree::c_api {

/// Records the status for ft_last_error() and gives its code back.
ft_status finish(const Status& status);

inline Status invalid(std::string message) {
  return {StatusCode::invalid_argument, std::move(message)};
}

inline Status null_pointer(const char* call, const char* what) {
  return invalid(std::string(call) + ": " + what + " is null");
}

/// Runs `work`, which returns a Status; what is thrown in it becomes one.
template <typename Work>
ft_status guarded(const Work& work) noexcept {
  try {
    return finish(work());
  } catch (const std::bad_alloc&) {
    return finish({StatusCode::resource_limit, "out of memory"});
  } catch (const std::length_error&) {
    return finish({StatusCode::resource_limit, "out of memory"});
  } catch (const std::system_error& e) {
    return finish({StatusCode::resource_limit, e.what()});
  } catch (const std::exception& e) {
    // The library throws nothing else, so this comes out of the caller's callback.
    return finish({StatusCode::cancelled, e.what()});
  } catch (...) {
    return finish({StatusCode::cancelled, "an exception came out of a callback"});
  }
}

/// A struct of the caller's, by its first member: too small is an error; what a later version may
/// have added has to be zero, since this library would not honour it.
template <typename Struct>
Status read_struct(const char* call, const char* what, const Struct* from, Struct& to) {
  if (from == nullptr) return null_pointer(call, what);
  std::size_t size = 0;
  std::memcpy(&size, from, sizeof size);
  if (size < sizeof(Struct)) {
    return invalid(std::string(call) + ": " + what + ".struct_size is " + std::to_string(size) +
                   "; set it to sizeof, at least " + std::to_string(sizeof(Struct)));
  }
  const auto* bytes = reinterpret_cast<const unsigned char*>(from);
  if (std::any_of(bytes + sizeof(Struct), bytes + size, [](unsigned char b) { return b != 0; })) {
    return invalid(std::string(call) + ": " + what +
                   " sets members that this version of the library does not know");
  }
  std::memcpy(&to, from, sizeof to);
  return {};
}

/// Writes what this version knows and leaves the rest, and struct_size, as they are.
template <typename Struct>
Status write_struct(const char* call, const char* what, Struct from, Struct* to) {
  if (to == nullptr) return null_pointer(call, what);
  std::size_t size = 0;
  std::memcpy(&size, to, sizeof size);
  if (size < sizeof(Struct)) {
    return invalid(std::string(call) + ": " + what + "->struct_size is " + std::to_string(size) +
                   "; set it to sizeof, at least " + std::to_string(sizeof(Struct)));
  }
  from.struct_size = size;
  std::memcpy(to, &from, sizeof from);
  return {};
}

Status read_mesh(const char* call, const ft_mesh* from, MeshView& to);

/// The largest number of threads a caller may ask for; more is a mistake, not a wish.
inline constexpr std::uint32_t kMaxThreads = 4096;

/// Runs `work` in the calling arena (0) or in one with so many threads. oneTBB has no more than the
/// process' limit to give, and would print a warning where more is asked for.
template <typename Work>
Status on_threads(const char* call, std::uint32_t threads, const Work& work) {
  if (threads > kMaxThreads) {
    return invalid(std::string(call) + ": " + std::to_string(threads) + " threads; at most " +
                   std::to_string(kMaxThreads));
  }
  if (threads == 0) return work();
  const std::size_t limit =
      tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism);
  tbb::task_arena arena(static_cast<int>(std::min<std::size_t>(threads, limit)));
  return arena.execute(work);
}

}  // namespace fasttree::c_api
