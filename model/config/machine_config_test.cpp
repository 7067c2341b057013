// SPDX-License-Identifier: Apache-2.0
#include "model/config/machine_config.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>

#include "model/config/embedded_configs.h"
#include "model/config/sections.h"

namespace fasttree::model {
namespace {

std::string error_of(const std::string& text) {
  const Result<MachineConfig> config = parse_config(text, "test");
  return config.ok() ? "" : config.status().message();
}

testing::AssertionResult says(const std::string& message,
                              std::initializer_list<const char*> parts) {
  for (const char* part : parts) {
    if (message.find(part) == std::string::npos) {
      return testing::AssertionFailure() << "'" << message << "' lacks '" << part << "'";
    }
  }
  return testing::AssertionSuccess();
}

TEST(MachineConfig, EveryEmbeddedOneLoads) {
  ASSERT_EQ(config_names(),
            (std::vector<std::string>{"fasttree-2-small", "fasttree-2", "paper-asic28",
                                      "paper-asic65", "paper-fpga"}));
  for (const std::string& name : config_names()) {
    const Result<MachineConfig> config = load_config(name);
    ASSERT_TRUE(config.ok()) << config.status().message();
    EXPECT_EQ(config.value().name, name);
  }
  EXPECT_EQ(load_config("paper-fpga").value().clock_mhz, 163);
  EXPECT_EQ(load_config("paper-fpga").value().memory.dram.channel_bits, 64u);
  EXPECT_EQ(load_config("paper-asic65").value().memory.dram.channels, 2u);
  EXPECT_EQ(load_config("paper-asic28").value().clock_mhz, 500);
  EXPECT_EQ(load_config("fasttree-2").value().architecture, "fasttree-2");
}

TEST(MachineConfig, UnknownNamesAreRefusedWithTheNearest) {
  EXPECT_TRUE(says(error_of("\n\nclok_mhz = 3\n"),
                   {"unknown key 'clok_mhz' in line 3; did you mean 'clock_mhz'?"}));
  EXPECT_TRUE(says(error_of("[memory]\ntrcdd_clocks = 3\n"),
                   {"'trcdd_clocks' of [memory] in line 2", "'trcd_clocks'"}));
  EXPECT_TRUE(says(error_of("[memroy]\n"), {"unknown section [memroy] in line 1", "'memory'"}));
  EXPECT_TRUE(says(error_of("[memory.deep]\n"), {"unknown key 'deep' of [memory]"}));
  EXPECT_TRUE(says(load_config("paper-asic6").status().message(), {"did you mean 'paper-asic65'"}));
  EXPECT_TRUE(says(error_of("[\"\"]\n"), {"unknown section []"}));
}

TEST(MachineConfig, WrongValuesAreRefusedWithWhatIsAllowed) {
  EXPECT_TRUE(says(error_of("\nclock_mhz = \"fast\""), {"line 2", "clock_mhz", "1 to 10000"}));
  EXPECT_TRUE(says(error_of("clock_mhz = nan"), {"line 1", "out of range"}));
  EXPECT_TRUE(says(error_of("clock_mhz = -4"), {"line 1", "out of range"}));
  EXPECT_TRUE(says(error_of("clock_mhz = [1]"), {"line 1", "not a single value"}));
  EXPECT_TRUE(says(error_of("[memory]\ncl_clocks = 0"), {"line 2", "cl_clocks", "1 to 255"}));
  EXPECT_TRUE(says(error_of("[memory]\ncl_clocks = -1"), {"line 2", "not a whole number"}));
  EXPECT_TRUE(says(error_of("[memory]\ncl_clocks = 1.5"), {"line 2", "not a whole number"}));
  EXPECT_TRUE(says(error_of("[memory]\nbanks = 7"), {"line 2", "not a power of two"}));
  EXPECT_TRUE(says(error_of("[memory]\ninterleave = \"bust\""),
                   {"line 2", "one of burst, row", "did you mean burst?"}));
  EXPECT_TRUE(says(error_of("[memory]\ntras_clocks = 3"), {"tras_clocks is less"}));
  EXPECT_TRUE(says(error_of("name = \"a\\\"b\""), {"line 1", "without quotes"}));
  EXPECT_TRUE(says(error_of("architecture = \"fasttree-2\"\n[paper]\n"),
                   {"section [paper] in line 2 is of architecture 'paper'"}));
  EXPECT_TRUE(says(error_of("clock_mhz 3"), {"test, line 1"}));
  EXPECT_TRUE(says(error_of("# \n# \xc3\xb6"), {"line 2", "ASCII"}));
  EXPECT_TRUE(says(error_of(std::string("a = 1\0", 6)), {"line 1", "ASCII"}));
}

TEST(MachineConfig, PresetComesBeforeTheOtherKeysWhereverItStands) {
  const auto config = parse_config("[memory]\ncl_clocks = 14\npreset = \"ddr3-1600\"\n", "test");
  ASSERT_TRUE(config.ok()) << config.status().message();
  EXPECT_EQ(config.value().memory.dram.cl, 14u);
  EXPECT_EQ(config.value().memory.dram.cwl, 8u);
  EXPECT_EQ(config.value().name, "test");
}

TEST(MachineConfig, TheMemoryThatIsNotGivenIsThePresetThatItNames) {
  const MachineConfig config = parse_config("clock_mhz = 100\n", "test").value();
  MachineConfig named = config;
  ASSERT_TRUE(apply_override(named, "memory.preset=" + config.memory.preset).ok());
  EXPECT_EQ(to_toml(named), to_toml(config));
}

TEST(MachineConfig, Overrides) {
  MachineConfig config = load_config("paper-asic65").value();
  ASSERT_TRUE(apply_override(config, "clock_mhz=720").ok());
  EXPECT_EQ(config.clock_mhz, 720);
  ASSERT_TRUE(apply_override(config, "memory.cl_clocks=14").ok());
  EXPECT_EQ(config.memory.dram.cl, 14u);
  ASSERT_TRUE(apply_override(config, "memory.interleave=row").ok());
  EXPECT_EQ(config.memory.controller.interleave, Interleave::row);
  ASSERT_TRUE(apply_override(config, "memory.preset=\"ideal\"").ok());
  EXPECT_EQ(config.memory.kind, MemoryKind::ideal);

  const std::string before = to_toml(config);
  const auto refused = [&](const char* text, std::initializer_list<const char*> parts) {
    const Status status = apply_override(config, text);
    EXPECT_FALSE(status.ok()) << text;
    EXPECT_TRUE(says(status.message(), parts));
  };
  refused("memory.cl_clocks", {"section.key=value"});
  refused("memory.cl_clocks=", {"1 to 255"});
  refused("memory.cl_clocks=9x", {"1 to 255"});
  refused("memory.cl_clocks=900", {"out of range", "1 to 255"});
  refused("memory.cl_clock=9", {"did you mean 'cl_clocks'"});
  refused("mem.cl_clocks=9", {"unknown section 'mem'"});
  refused("fasttree2.lanes=8", {"is of architecture 'fasttree-2'"});
  EXPECT_EQ(to_toml(config), before);
}

TEST(MachineConfig, WrittenOneReadsAsTheSame) {
  for (const std::string& name : config_names()) {
    MachineConfig config = load_config(name).value();
    ASSERT_TRUE(apply_override(config, "clock_mhz=333.25").ok());
    ASSERT_TRUE(apply_override(config, "memory.tfaw_clocks=41").ok());
    const std::string text = to_toml(config);
    const Result<MachineConfig> again = parse_config(text, "written");
    ASSERT_TRUE(again.ok()) << again.status().message();
    EXPECT_EQ(to_toml(again.value()), text);
    EXPECT_EQ(again.value().memory.dram.tfaw, 41u);
  }
}

TEST(MachineConfig, EveryFieldTakesItsLimitsAndHasAComment) {
  for (const Section& section : config_sections()) {
    for (const Field& field : section.fields) {
      EXPECT_FALSE(field.comment.empty()) << field.key;
      MachineConfig config;
      if (field.kind == Field::Kind::count || field.kind == Field::Kind::power_of_two) {
        for (const double limit : {field.least, field.most}) {
          const FieldValue value(static_cast<std::uint64_t>(limit));
          EXPECT_TRUE(set_field(section, field, config, value, "").ok()) << field.key;
          EXPECT_EQ(field.get(section.of(config)), value) << field.key;
        }
        const FieldValue over(static_cast<std::uint64_t>(field.most) + 1);
        EXPECT_FALSE(set_field(section, field, config, over, "").ok()) << field.key;
      }
      for (const std::string& choice : field.choices) {
        EXPECT_TRUE(set_field(section, field, config, choice, "").ok()) << field.key;
        EXPECT_EQ(field.get(section.of(config)), FieldValue(choice)) << field.key;
      }
    }
  }
}

TEST(MachineConfig, FromAFile) {
  const auto path = std::filesystem::temp_directory_path() / "fasttree_machine_config_test.toml";
  std::ofstream(path) << "clock_mhz = 77\n";
  const Result<MachineConfig> config = load_config(path.string());
  std::filesystem::remove(path);
  ASSERT_TRUE(config.ok()) << config.status().message();
  EXPECT_EQ(config.value().clock_mhz, 77);
  EXPECT_EQ(load_config(path.string()).status().code(), StatusCode::io_error);
}

// Whatever the bytes: a configuration or a message, never a crash.
TEST(MachineConfig, TruncationsAreReadOrRefused) {
  for (const EmbeddedConfig& config : embedded_configs()) {
    for (std::size_t n = 0; n <= config.text.size(); ++n) {
      const auto result = parse_config(config.text.substr(0, n), "cut");
      EXPECT_TRUE(result.ok() || !result.status().message().empty());
    }
  }
}

RC_GTEST_PROP(MachineConfig, RandomBytesAreReadOrRefused, (const std::string& bytes)) {
  const auto result = parse_config(bytes, "random");
  if (!result.ok()) RC_ASSERT(!result.status().message().empty());
}

RC_GTEST_PROP(MachineConfig, RandomTextIsReadOrRefused, ()) {
  // The characters that mean something in TOML, and a few that do not.
  const std::string alphabet = "[]{}=.,\"'#\\\n\r\t +-_:0123456789abcdefTxuUeinZ";
  std::string text;
  const int length = *rc::gen::inRange(0, 60);
  for (int i = 0; i < length; ++i) {
    text += alphabet[*rc::gen::inRange<std::size_t>(0, alphabet.size())];
  }
  const auto result = parse_config(text, "random");
  if (!result.ok()) RC_ASSERT(!result.status().message().empty());
}

RC_GTEST_PROP(MachineConfig, DamagedOnesAreReadOrRefused, ()) {
  const auto configs = embedded_configs();
  std::string text(configs[*rc::gen::inRange<std::size_t>(0, configs.size())].text);
  const int changes = *rc::gen::inRange(1, 8);
  for (int i = 0; i < changes; ++i) {
    text[*rc::gen::inRange<std::size_t>(0, text.size())] = *rc::gen::arbitrary<char>();
  }
  const auto result = parse_config(text, "damaged");
  if (!result.ok()) RC_ASSERT(!result.status().message().empty());
}

TEST(MachineConfig, DeepNestingIsRefused) {
  EXPECT_NE(error_of("a = " + std::string(100000, '[')), "");
  EXPECT_NE(error_of(std::string(2 << 20, '#')), "");
}

}  // namespace
}  // namespace fasttree::model
