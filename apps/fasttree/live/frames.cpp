// SPDX-License-Identifier: Apache-2.0
#include "live/frames.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>
#include <system_error>

#include "scene/procedural/procedural.h"

namespace fasttree::live {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kPrefix = "scene:";

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

std::string_view take_digits(std::string_view text, std::size_t from) {
  std::size_t end = from;
  while (end < text.size() && is_digit(text[end])) ++end;
  return text.substr(from, end - from);
}

bool has_mesh_extension(const fs::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  constexpr std::array kExtensions{".ply", ".obj", ".stl", ".gltf", ".glb"};
  return std::find(kExtensions.begin(), kExtensions.end(), extension) != kExtensions.end();
}

Result<Frames> list_folder(const std::string& source) {
  std::error_code error;
  std::vector<std::string> names;
  bool empty = true;
  for (fs::directory_iterator entry(source, error), end; !error && entry != end;
       entry.increment(error)) {
    empty = false;
    const fs::path& path = entry->path();
    std::error_code ignored;  // an entry that cannot be looked at is no frame
    if (path.filename().string().starts_with(".") || !has_mesh_extension(path)) continue;
    if (entry->is_regular_file(ignored)) names.push_back(path.filename().string());
  }
  if (error) {
    return Status(StatusCode::io_error,
                  "cannot read the folder " + source + ": " + error.message());
  }
  if (names.empty()) {
    return Status(StatusCode::bad_input,
                  "the folder " + source +
                      (empty ? " is empty" : " holds no mesh file (PLY, OBJ, STL, glTF, GLB)") +
                      "; put one mesh file a frame into it, such as 000.ply, 001.ply");
  }
  std::sort(names.begin(), names.end(), natural_less);
  Frames frames;
  frames.folder = true;
  const fs::path folder(source);
  frames.name = (folder.has_filename() ? folder : folder.parent_path()).filename().string();
  for (const std::string& name : names) frames.specs.push_back((folder / name).string());
  return frames;
}

}  // namespace

bool natural_less(std::string_view a, std::string_view b) {
  std::size_t i = 0, j = 0;
  while (i < a.size() && j < b.size()) {
    if (is_digit(a[i]) && is_digit(b[j])) {
      std::string_view x = take_digits(a, i), y = take_digits(b, j);
      i += x.size();
      j += y.size();
      x.remove_prefix(std::min(x.find_first_not_of('0'), x.size()));
      y.remove_prefix(std::min(y.find_first_not_of('0'), y.size()));
      // Of two numbers without leading zeros, that with more digits is larger.
      if (x.size() != y.size()) return x.size() < y.size();
      if (x != y) return x < y;
    } else {
      if (a[i] != b[j]) return a[i] < b[j];
      ++i;
      ++j;
    }
  }
  if (i < a.size() || j < b.size()) return j < b.size();
  return a < b;  // the same but for leading zeros
}

Result<Frames> list_frames(const std::string& source) {
  Frames frames;
  frames.name = source;
  frames.specs = {source};
  if (!source.starts_with(kPrefix)) {
    std::error_code error;  // what cannot be looked at is left to the reader's message
    if (fs::is_directory(source, error)) return list_folder(source);
    return frames;
  }
  // scene:NAME or scene:NAME:TRIANGLES; with a frame behind it, it is that frame alone.
  std::string_view fields = std::string_view(source).substr(kPrefix.size());
  const std::size_t colon = fields.find(':');
  const std::string_view name = fields.substr(0, colon);
  if (colon != std::string_view::npos && fields.find(':', colon + 1) != std::string_view::npos) {
    return frames;
  }
  for (const scene::ProceduralInfo& info : scene::procedural_scenes()) {
    if (name != info.name || info.frames == 1) continue;
    const std::string stem = source + (colon == std::string_view::npos ? "::" : ":");
    frames.specs.clear();
    for (std::uint32_t f = 0; f < info.frames; ++f)
      frames.specs.push_back(stem + std::to_string(f));
  }
  return frames;
}

std::string frame_label(const Frames& frames, std::size_t frame) {
  const std::string& spec = frames.specs[frame];
  return spec.starts_with(kPrefix) ? spec : fs::path(spec).filename().string();
}

std::string not_moving(const std::string& source) {
  if (!source.starts_with(kPrefix)) {
    return "'" + source + "' is one mesh and does not move; give a folder with one mesh file a " +
           "frame, or look at it with fasttree view";
  }
  const std::string name = source.substr(0, source.find(':', kPrefix.size()));
  std::string moving;
  for (const scene::ProceduralInfo& info : scene::procedural_scenes()) {
    if (info.frames == 1) continue;
    if (name == std::string(kPrefix) + info.name) {
      return "'" + source + "' is one frame; leave the frame's number out for all " +
             std::to_string(info.frames);
    }
    moving += (moving.empty() ? "" : ", ") + std::string(kPrefix) + info.name;
  }
  return "'" + source + "' does not move; these do: " + moving;
}

}  // namespace fasttree::live
