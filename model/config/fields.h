// SPDX-License-Identifier: Apache-2.0
// What a section of a configuration holds, declared once: key (with its unit), member, what is
// allowed, and one line of comment. Reading, overriding, writing and the documentation follow.
#pragma once

#include <concepts>
#include <cstdint>
#include <functional>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

namespace fasttree::model {

using FieldValue = std::variant<bool, std::uint64_t, double, std::string>;

/// One key of a section, without the type of its struct.
struct Field {
  enum class Kind : std::uint8_t { flag, count, power_of_two, real, choice, text };

  std::string key;
  std::string comment;
  Kind kind = Kind::flag;
  double least = 0;  ///< count, power_of_two, real
  double most = 0;
  std::vector<std::string> choices;  ///< choice
  std::function<FieldValue(const void* section)> get;
  std::function<void(void* section, const FieldValue&)> set;
};

/// The keys of `Struct`, in the order they are written out:
///   fields.count("bus_bytes_per_cycle", &PaperConfig::bus_bytes_per_cycle, 1, 256, "What ...");
template <typename Struct>
class Fields {
 public:
  /// true or false.
  Fields& flag(const char* key, bool Struct::*member, const char* comment) {
    return add<bool>(key, member, comment, Field::Kind::flag, 0, 1);
  }

  /// A whole number from `least` to `most`.
  template <std::unsigned_integral T>
  Fields& count(const char* key, T Struct::*member, std::uint64_t least, std::uint64_t most,
                const char* comment) {
    return add<std::uint64_t>(key, member, comment, Field::Kind::count, static_cast<double>(least),
                              static_cast<double>(most));
  }

  /// A power of two from `least` to `most`.
  template <std::unsigned_integral T>
  Fields& power_of_two(const char* key, T Struct::*member, std::uint64_t least, std::uint64_t most,
                       const char* comment) {
    return add<std::uint64_t>(key, member, comment, Field::Kind::power_of_two,
                              static_cast<double>(least), static_cast<double>(most));
  }

  /// A real number from `least` to `most`.
  Fields& real(const char* key, double Struct::*member, double least, double most,
               const char* comment) {
    return add<double>(key, member, comment, Field::Kind::real, least, most);
  }

  /// One of `names`, which are in the order of the enumeration's values from 0.
  template <typename Enum>
  requires std::is_enum_v<Enum> Fields& choice(const char* key, Enum Struct::*member,
                                               std::vector<std::string> names,
                                               const char* comment) {
    Field& field = begin(key, comment, Field::Kind::choice);
    field.choices = names;
    field.get = [member, names](const void* s) {
      return FieldValue(names[static_cast<std::size_t>(static_cast<const Struct*>(s)->*member)]);
    };
    field.set = [member, names](void* s, const FieldValue& value) {
      for (std::size_t i = 0; i < names.size(); ++i) {
        if (names[i] == std::get<std::string>(value)) {
          static_cast<Struct*>(s)->*member = static_cast<Enum>(i);
        }
      }
    };
    return *this;
  }

  /// One of `names`, kept as text.
  Fields& choice(const char* key, std::string Struct::*member, std::vector<std::string> names,
                 const char* comment) {
    add<std::string>(key, member, comment, Field::Kind::choice, 0, 0);
    list_.back().choices = std::move(names);
    return *this;
  }

  /// Any text of one line.
  Fields& text(const char* key, std::string Struct::*member, const char* comment) {
    return add<std::string>(key, member, comment, Field::Kind::text, 0, 0);
  }

  /// The keys of a struct inside this one, as if they were this section's own.
  template <typename Inner>
  Fields& include(Inner Struct::*member, const Fields<Inner>& inner) {
    for (const Field& of_inner : inner.list()) {
      Field& field = list_.emplace_back(of_inner);
      field.get = [member, get = of_inner.get](const void* s) {
        return get(&(static_cast<const Struct*>(s)->*member));
      };
      field.set = [member, set = of_inner.set](void* s, const FieldValue& value) {
        set(&(static_cast<Struct*>(s)->*member), value);
      };
    }
    return *this;
  }

  const std::vector<Field>& list() const { return list_; }

 private:
  Field& begin(const char* key, const char* comment, Field::Kind kind) {
    Field& field = list_.emplace_back();
    field.key = key;
    field.comment = comment;
    field.kind = kind;
    return field;
  }

  template <typename Held, typename T>
  Fields& add(const char* key, T Struct::*member, const char* comment, Field::Kind kind,
              double least, double most) {
    Field& field = begin(key, comment, kind);
    field.least = least;
    field.most = most;
    field.get = [member](const void* s) {
      return FieldValue(static_cast<Held>(static_cast<const Struct*>(s)->*member));
    };
    field.set = [member](void* s, const FieldValue& value) {
      static_cast<Struct*>(s)->*member = static_cast<T>(std::get<Held>(value));
    };
    return *this;
  }

  std::vector<Field> list_;
};

}  // namespace fasttree::model
