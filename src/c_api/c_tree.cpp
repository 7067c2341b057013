// SPDX-License-Identifier: Apache-2.0
#include "c_api/handles.h"
#include "fasttree/tree_file.h"
#include "fasttree/verify.h"

using namespace fasttree;
using namespace fasttree::c_api;

namespace {

template <typename Read>
Status read_tree(const char* call, const char* path, ft_tree** tree, const Read& read) {
  if (tree == nullptr) return null_pointer(call, "tree");
  *tree = nullptr;
  if (path == nullptr) return null_pointer(call, "path");
  Result<Tree> result = read(path);
  if (!result.ok()) return result.status();
  *tree = new ft_tree{std::make_shared<Tree>(std::move(result).value())};
  return {};
}

template <std::size_t N>
void copy_text(const std::string& from, char (&to)[N]) {
  const std::size_t length = std::min(from.size(), N - 1);
  std::memcpy(to, from.data(), length);
  to[length] = '\0';
}

}  // namespace

void ft_tree_free(ft_tree* tree) {
  delete tree;
}

ft_status ft_tree_get_info(const ft_tree* tree, ft_tree_info* info) {
  return guarded([&]() -> Status {
    constexpr char kCall[] = "ft_tree_get_info";
    if (tree == nullptr) return null_pointer(kCall, "tree");
    const Tree& t = *tree->tree;
    const auto& [lo, hi] = t.info().bounds;
    ft_tree_info out = FT_TREE_INFO_INIT;
    out.profile = static_cast<std::uint32_t>(t.info().profile);
    out.axes = static_cast<std::uint32_t>(t.info().axes);
    out.depth = t.info().depth;
    out.triangle_count = t.info().triangle_count;
    out.node_count = t.nodes().size();
    out.leaf_count = t.leaf_count();
    out.id_count = t.ids().size();
    for (std::size_t a = 0; a < 3; ++a) {
      out.bounds_lo[a] = lo[a];
      out.bounds_hi[a] = hi[a];
      out.bits[a] = t.info().bits[a];
    }
    return write_struct(kCall, "info", out, info);
  });
}

ft_status ft_tree_get_nodes(const ft_tree* tree, const uint32_t** words) {
  return guarded([&]() -> Status {
    if (tree == nullptr) return null_pointer("ft_tree_get_nodes", "tree");
    if (words == nullptr) return null_pointer("ft_tree_get_nodes", "words");
    static_assert(sizeof(Node) == 2 * sizeof(std::uint32_t));
    // A Node is two 32-bit words, and is read as such.
    *words = reinterpret_cast<const std::uint32_t*>(tree->tree->nodes().data());
    return {};
  });
}

ft_status ft_tree_get_ids(const ft_tree* tree, const uint32_t** ids) {
  return guarded([&]() -> Status {
    if (tree == nullptr) return null_pointer("ft_tree_get_ids", "tree");
    if (ids == nullptr) return null_pointer("ft_tree_get_ids", "ids");
    *ids = tree->tree->ids().data();
    return {};
  });
}

ft_status ft_tree_get_hash(const ft_tree* tree, uint64_t* hash) {
  return guarded([&]() -> Status {
    if (tree == nullptr) return null_pointer("ft_tree_get_hash", "tree");
    if (hash == nullptr) return null_pointer("ft_tree_get_hash", "hash");
    *hash = tree->tree->hash();
    return {};
  });
}

ft_status ft_tree_save(const ft_tree* tree, const char* path) {
  return guarded([&]() -> Status {
    if (tree == nullptr) return null_pointer("ft_tree_save", "tree");
    if (path == nullptr) return null_pointer("ft_tree_save", "path");
    return save_tree(*tree->tree, path);
  });
}

ft_status ft_tree_load(const char* path, ft_tree** tree) {
  return guarded([&] { return read_tree("ft_tree_load", path, tree, load_tree); });
}

ft_status ft_tree_map(const char* path, ft_tree** tree) {
  return guarded([&] { return read_tree("ft_tree_map", path, tree, map_tree); });
}

ft_status ft_tree_verify(const ft_tree* tree, const ft_mesh* mesh, ft_verification* verification) {
  return guarded([&]() -> Status {
    constexpr char kCall[] = "ft_tree_verify";
    if (tree == nullptr) return null_pointer(kCall, "tree");
    MeshView view;
    if (mesh != nullptr) {
      if (Status s = read_mesh(kCall, mesh, view); !s.ok()) return s;
    }
    ft_verification out = FT_VERIFICATION_INIT;
    // Checked before the long work, too.
    if (Status s = write_struct(kCall, "verification", out, verification); !s.ok()) return s;
    const Verification found = mesh ? verify(*tree->tree, view) : verify(*tree->tree);
    out.ok = found.ok ? 1 : 0;
    out.checks = found.checks;
    copy_text(found.invariant, out.invariant);
    copy_text(found.detail, out.detail);
    return write_struct(kCall, "verification", out, verification);
  });
}
