// Configuration file: accepted contents, and the error for each mistake.

#include "daemon/service/configuration.hpp"

#include <fstream>
#include <regex>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include "support/places.hpp"
#include "support/temporary_folder.hpp"

namespace cartvo::daemon {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

const std::filesystem::path kShipped = test::sourceFolder() / "config/cartvod.yaml";

constexpr const char* kMinimal = R"(cameras:
  left:
    url: rtsp://10.0.0.1/left
  right:
    url: rtsp://10.0.0.2/right
rig: rig.yaml
)";

class ConfigurationFile : public testing::Test {
 protected:
  Configuration read(const std::string& text) {
    const std::filesystem::path file = folder_ / "cartvod.yaml";
    std::ofstream(file) << text;
    return readConfiguration(file);
  }

  /// The error's text; fails the test if there is none.
  std::string errorOf(const std::string& text) {
    try {
      read(text);
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    ADD_FAILURE() << "accepted:\n" << text;
    return {};
  }

  test::TemporaryFolder folder_;
};

TEST_F(ConfigurationFile, RequiresOnlyTwoUrlsAndRig) {
  const Configuration configuration = read(kMinimal);
  EXPECT_EQ(configuration.left.url, "rtsp://10.0.0.1/left");
  EXPECT_EQ(configuration.right.url, "rtsp://10.0.0.2/right");
  EXPECT_EQ(configuration.rig, folder_ / "rig.yaml");
  EXPECT_TRUE(configuration.tables.empty());
  EXPECT_TRUE(configuration.recording_directory.empty());
}

TEST_F(ConfigurationFile, ResolvesRelativePathsFromItsFolder) {
  const Configuration configuration =
      read(std::string(kMinimal) + "tables: cache/tables.bin\nrecording: {directory: /var/lib/x}\n");
  EXPECT_EQ(configuration.tables, folder_ / "cache/tables.bin");
  EXPECT_EQ(configuration.recording_directory, "/var/lib/x");
  EXPECT_TRUE(configuration.recording_quota.recordings.empty()) << "set by cartvod";
}

TEST_F(ConfigurationFile, NamesUnknownKeyWithFileAndLine) {
  EXPECT_THAT(errorOf(std::string(kMinimal) + "odometry:\n  feature: 1000\n"),
              AllOf(HasSubstr("cartvod.yaml:8: odometry.feature"),
                    HasSubstr("estimator, features, seed, threads, online_rig_refinement")));
  EXPECT_THAT(errorOf(std::string(kMinimal) + "camera: 1\n"), HasSubstr("cartvod.yaml:7: camera"));
}

TEST_F(ConfigurationFile, NamesDuplicateKey) {
  EXPECT_THAT(errorOf(std::string(kMinimal) + "rig: other.yaml\n"),
              AllOf(HasSubstr("cartvod.yaml:7: rig"), HasSubstr("each key once")));
}

TEST_F(ConfigurationFile, NamesMissingKey) {
  EXPECT_THAT(errorOf("cameras:\n  left: {url: rtsp://a/1}\n  right: {url: rtsp://a/2}\n"),
              AllOf(HasSubstr("cartvod.yaml"), HasSubstr("rig"), HasSubstr("missing")));
  EXPECT_THAT(errorOf("cameras:\n  left: {url: rtsp://a/1}\nrig: rig.yaml\n"),
              AllOf(HasSubstr("cartvod.yaml:2"), HasSubstr("cameras.right"), HasSubstr("missing")));
}

TEST_F(ConfigurationFile, NamesWrongTypeAndValueOutOfRange) {
  EXPECT_THAT(errorOf(std::string(kMinimal) + "odometry: {features: many}\n"),
              AllOf(HasSubstr("cartvod.yaml:7: odometry.features"), HasSubstr("an integer from 50 to 20000"),
                    HasSubstr("'many'")));
  EXPECT_THAT(errorOf(std::string(kMinimal) + "odometry: {features: 10}\n"), HasSubstr("found '10'"));
  EXPECT_THAT(errorOf(std::string(kMinimal) + "odometry: [1, 2]\n"), HasSubstr("a map of keys and values"));
  EXPECT_THAT(errorOf(std::string(kMinimal) + "lcm: {time_to_live: 0}\n"),
              AllOf(HasSubstr("lcm.time_to_live"), HasSubstr("a number from 0.01 to 10")));
  EXPECT_THAT(errorOf(std::string(kMinimal) + "logging: {level: loud}\n"),
              AllOf(HasSubstr("logging.level"), HasSubstr("one of debug, info, warning, error"),
                    HasSubstr("'loud'")));
  EXPECT_THAT(errorOf(std::string(kMinimal) + "lcm: {url: \"tcp://1.2.3.4\"}\n"),
              HasSubstr("udpm://239.255.76.67"));
  EXPECT_THAT(errorOf(std::string(kMinimal) + "lcm: {url: \"udpm://10.0.0.1:7667?ttl=0\"}\n"),
              AllOf(HasSubstr("cartvod.yaml:7: lcm.url"),
                    HasSubstr("names '10.0.0.1', which is not a multicast address")));
}

TEST_F(ConfigurationFile, ReadsAlertLimitsWithAnglesInDegrees) {
  const pipeline::AlertLimits defaults = read(kMinimal).alert_limits;
  EXPECT_NEAR(defaults.angular_rate, 0.2094395, 1e-6);
  const Configuration configuration = read(
      std::string(kMinimal) + "odometry: {alert_limits: {velocity: 0.5, angular_rate: 90, rotation: 3}}\n");
  EXPECT_EQ(configuration.alert_limits.velocity, 0.5);
  EXPECT_NEAR(configuration.alert_limits.angular_rate, 1.5707963, 1e-6);
  EXPECT_EQ(configuration.alert_limits.motion, defaults.motion);
  EXPECT_NEAR(configuration.alert_limits.rotation, 0.0523599, 1e-6);
  EXPECT_THAT(effectiveConfiguration(configuration),
              AllOf(HasSubstr("velocity: 0.5"), HasSubstr("angular_rate: 90"), HasSubstr("motion: 0.2"),
                    HasSubstr("rotation: 3")));
}

TEST_F(ConfigurationFile, RefusesAlertLimitsThatAreNone) {
  const auto error = [this](const std::string& limits) {
    return errorOf(std::string(kMinimal) + "odometry: {alert_limits: {" + limits + "}}\n");
  };
  EXPECT_THAT(error("speed: 0.3"), AllOf(HasSubstr("cartvod.yaml:7: odometry.alert_limits.speed"),
                                         HasSubstr("velocity, angular_rate, motion, rotation")));
  for (const char* value : {"0", "-0.3", "101", ".inf", ".nan", "wide"})
    EXPECT_THAT(error(std::string("velocity: ") + value), HasSubstr("a number from 0.01 to 100")) << value;
  EXPECT_THAT(error("angular_rate: 0.05"), HasSubstr("a number from 0.1 to 1000"));
  EXPECT_THAT(error("motion: 0"), HasSubstr("odometry.alert_limits.motion"));
  EXPECT_THAT(error("rotation: 181"), HasSubstr("a number from 0.1 to 180"));
}

TEST_F(ConfigurationFile, ReadsThePoseChannelOnlyWithTheAxesOfItsVelocity) {
  EXPECT_EQ(read(kMinimal).pose_channel, "");
  const Configuration configuration =
      read(std::string(kMinimal) + "lcm: {pose_channel: POSE_BODY, pose_velocity: body}\n");
  EXPECT_EQ(configuration.pose_channel, "POSE_BODY");
  EXPECT_EQ(configuration.pose_velocity, PoseVelocity::body);
  const std::string text = effectiveConfiguration(configuration);
  EXPECT_THAT(text, AllOf(HasSubstr("pose_channel: POSE_BODY"), HasSubstr("pose_velocity: body")));
  EXPECT_EQ(effectiveConfiguration(read(text)), text);
  EXPECT_THAT(errorOf(std::string(kMinimal) + "lcm: {pose_channel: POSE_BODY}\n"),
              HasSubstr("needs pose_velocity"));
  EXPECT_THAT(errorOf(std::string(kMinimal) + "lcm: {pose_velocity: local}\n"),
              HasSubstr("lcm.pose_channel"));
  for (const char* channel : {"CARTVO_ODOMETRY", "''", "a b", "'#'"}) {
    EXPECT_THAT(
        errorOf(std::string(kMinimal) + "lcm: {pose_velocity: local, pose_channel: " + channel + "}\n"),
        HasSubstr("a channel such as POSE_BODY"));
  }
}

TEST_F(ConfigurationFile, ServesMetricsToThisComputerOnly) {
  EXPECT_FALSE(read(kMinimal).metrics);
  const Configuration configuration = read(std::string(kMinimal) + "metrics: {listen: 9464}\n");
  ASSERT_TRUE(configuration.metrics);
  EXPECT_EQ(configuration.metrics->text(), "127.0.0.1:9464");
  const std::string text = effectiveConfiguration(configuration);
  EXPECT_EQ(effectiveConfiguration(read(text)), text);
  for (const char* address : {"0.0.0.0:9464", "192.168.1.2:9464", "'[::]:9464'", "127.0.0.1:0"}) {
    EXPECT_THAT(errorOf(std::string(kMinimal) + "metrics: {listen: " + address + "}\n"),
                AllOf(HasSubstr("metrics.listen"), HasSubstr("a port of this computer")));
  }
  EXPECT_THAT(errorOf(std::string(kMinimal) + "metrics: {listen: http}\n"),
              HasSubstr("neither PORT nor ADDRESS:PORT"));
}

TEST_F(ConfigurationFile, ServesTheStatusPageToOtherComputersOnlyWithAToken) {
  EXPECT_FALSE(read(kMinimal).page.listen);
  EXPECT_EQ(read(std::string(kMinimal) + "page: {listen: 9465}\n").page.listen->text(), "127.0.0.1:9465");
  const Configuration configuration =
      read(std::string(kMinimal) +
           "page: {listen: \"0.0.0.0:9465\", token_file: token}\nrecording: {start: by_hand}\n");
  EXPECT_EQ(configuration.page.token_file.filename(), "token");
  EXPECT_TRUE(configuration.page.token_file.is_absolute());
  EXPECT_EQ(configuration.recording_start, RecordingStart::by_hand);
  const std::string text = effectiveConfiguration(configuration);
  EXPECT_EQ(effectiveConfiguration(read(text)), text);
  EXPECT_THAT(
      errorOf(std::string(kMinimal) + "page: {listen: \"0.0.0.0:9465\"}\n"),
      AllOf(HasSubstr("cartvod.yaml:7: page.listen"), HasSubstr("needs token_file or token_credential")));
  EXPECT_THAT(errorOf(std::string(kMinimal) + "page: {listen: 0}\n"), HasSubstr("page.listen"));
  EXPECT_THAT(errorOf(std::string(kMinimal) + "page: {token_file: a, token_credential: b}\n"),
              HasSubstr("not both"));
  EXPECT_THAT(errorOf(std::string(kMinimal) + "page: {token_credential: ../b}\n"),
              HasSubstr("the name of a systemd credential"));
  EXPECT_THAT(errorOf(std::string(kMinimal) + "recording: {start: later}\n"),
              HasSubstr("one of automatic, by_hand"));
}

TEST_F(ConfigurationFile, ErrorExplainsThatMonitorWasRemoved) {
  EXPECT_THAT(errorOf(std::string(kMinimal) + "odometry: {online_rig_refinement: monitor}\n"),
              AllOf(HasSubstr("cartvod.yaml:7: odometry.online_rig_refinement"),
                    HasSubstr("'monitor' was removed: use 'correct'"), HasSubstr("or 'off'")));
}

TEST_F(ConfigurationFile, NamesLineThatIsNotYaml) {
  EXPECT_THAT(errorOf("cameras:\n  left: {url: [}\n"),
              AllOf(HasSubstr("cartvod.yaml:2"), HasSubstr("not YAML")));
}

TEST_F(ConfigurationFile, ExplainsWhatIsNotYaml) {
  const std::string minimal(kMinimal);
  for (const auto& [text, message] : std::vector<std::pair<std::string, std::string>>{
           {minimal + "lcm:\n  url:x\n  time_to_live: 1\n",
            "expected 'key: value', with a blank behind the colon"},
           {minimal + "lcm:\n  url: a\n   ttl: 1\n", "expected 'key: value', with a blank behind the colon"},
           {minimal + "lcm:\n    url: a\n  ttl: 1\n", "this line is indented otherwise than the lines"},
           {minimal + "lcm: {url: a\n", "a '{' is not closed by '}'"},
           {"[a],\n" + minimal, "expected one value, found more behind its end"},
           {",", "expected one value, found more behind its end"},
           {minimal + "lcm: " + std::string(5000, '['), "it is nested too deeply"}}) {
    EXPECT_THAT(errorOf(text), AllOf(HasSubstr("cartvod.yaml:"), HasSubstr("is not YAML: " + message)))
        << text;
  }
}

TEST_F(ConfigurationFile, MustBeOneDocument) {
  const std::string minimal(kMinimal);
  EXPECT_THAT(errorOf(minimal + "---\n" + minimal),
              HasSubstr("a second document begins behind '---'; expected one"));
  EXPECT_NO_THROW(read("---\n" + minimal + "...\n---\n"));
}

TEST_F(ConfigurationFile, NamesMissingFile) {
  try {
    readConfiguration(folder_ / "none.yaml");
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(),
                AllOf(HasSubstr("none.yaml"), HasSubstr("cannot be read: No such file or directory")));
  }
}

TEST_F(ConfigurationFile, RejectsPasswordInUrlWithoutQuotingIt) {
  const std::string error = errorOf(
      "cameras:\n  left:\n    url: rtsp://admin:geheim@10.0.0.1/left\n  right: {url: rtsp://b/2}\nrig: r\n");
  EXPECT_THAT(error, AllOf(HasSubstr("cartvod.yaml:3: cameras.left.url"), HasSubstr("password_file"),
                           Not(HasSubstr("geheim"))));
}

TEST_F(ConfigurationFile, RejectsInconsistentCredentials) {
  const auto with = [](const std::string& left) {
    return "cameras:\n  left: {url: rtsp://a/1, " + left + "}\n  right: {url: rtsp://a/2}\nrig: rig.yaml\n";
  };
  EXPECT_THAT(errorOf(with("username: admin")),
              AllOf(HasSubstr(":2: cameras.left"), HasSubstr("password_file or")));
  EXPECT_THAT(errorOf(with("password_file: p")), HasSubstr("needs username"));
  EXPECT_THAT(errorOf(with("username: u, password_file: p, password_credential: c")), HasSubstr("not both"));
  EXPECT_THAT(errorOf(with("username: u, password_credential: ../c")), HasSubstr("without '/'"));
  EXPECT_THAT(errorOf(with("username: u, password_credential: ..")), HasSubstr("without '/'"));
}

TEST_F(ConfigurationFile, RejectsUnsupportedUrlScheme) {
  EXPECT_THAT(errorOf("cameras:\n  left: {url: rtsps://a/1}\n  right: {url: rtsp://a/2}\nrig: rig.yaml\n"),
              AllOf(HasSubstr(":2: cameras.left.url"), HasSubstr("use rtsp://"), HasSubstr("rtsps://a/1")));
  EXPECT_THAT(
      errorOf("cameras:\n  left: {url: http://a/1}\n  right: {url: rtsp://a/2}\nrig: rig.yaml\n"),
      AllOf(HasSubstr("rtsp://192.168.1.64"), HasSubstr("v4l2:/dev/video0"), HasSubstr("http://a/1")));
}

TEST_F(ConfigurationFile, RejectsUnprintableText) {
  const auto with = [](const std::string& rig) {
    return "cameras:\n  left: {url: rtsp://a/1}\n  right: {url: rtsp://a/2}\nrig: \"" + rig + "\"\n";
  };
  for (const std::string rig :
       {"r\\r", "r\\n", "\\e[2J", "\\x7f", "r\xDBr", "\xC0\x80", "\xE0\x80\x80", "\xED\xA0\x80",
        "\xF0\x80\x80\x80", "\xF4\x90\x80\x80", "\xF8\x88\x80\x80\x80", "\xE2\x82", "\xC2\x85",
        "\xC2\x9B"
        "2J",
        "\xE2\x80\xA8", "\xE2\x80\xAE", "\xE2\x81\xA6"}) {
    EXPECT_THAT(errorOf(with(rig)), HasSubstr("cartvod.yaml:4: rig: expected text of printable characters"))
        << rig;
  }
  EXPECT_THAT(errorOf(std::string(kMinimal) + "odometry: {features: \"\\e[2J\"}\n"),
              HasSubstr("found '\\x1b[2J'"));
  std::string accents = "a";
  for (int i = 0; i < 40; ++i)
    accents += "\xC3\xA9";
  EXPECT_THAT(errorOf(std::string(kMinimal) + "odometry: {features: " + accents + "}\n"),
              HasSubstr("\xC3\xA9...'"))
      << "cut between two characters";
  for (const std::string rig : {"/r\xC3\xA9"
                                "e",
                                "/\xE2\x82\xAC", "/\xF0\x9F\x9B\xBA"}) {
    EXPECT_EQ(read(with(rig)).rig.string(), rig);
    const std::string text = effectiveConfiguration(read(with(rig)));
    EXPECT_EQ(effectiveConfiguration(read(text)), text);
  }
}

TEST_F(ConfigurationFile, ReadsClockChoice) {
  const auto with = [](const std::string& clock) {
    return "cameras:\n  left: {url: rtsp://a/1}\n  right: {url: rtsp://a/2}\n  clock: " + clock +
           "\nrig: rig.yaml\n";
  };
  EXPECT_EQ(read(kMinimal).clock, capture::ClockChoice::automatic);
  EXPECT_EQ(read(with("ntp")).clock, capture::ClockChoice::ntp);
  EXPECT_EQ(read(with("arrival")).clock, capture::ClockChoice::arrival);
  EXPECT_EQ(read(with("visual")).clock, capture::ClockChoice::visual);
  EXPECT_THAT(effectiveConfiguration(read(with("arrival"))), HasSubstr("clock: arrival"));
  EXPECT_THAT(errorOf(with("gps")), HasSubstr("one of auto, ntp, arrival, visual"));
}

TEST_F(ConfigurationFile, ReadsCameraTimeouts) {
  const auto with = [](const std::string& cameras) {
    return "cameras:\n  left: {url: rtsp://a/1}\n  right: {url: rtsp://a/2}\n" + cameras + "rig: rig.yaml\n";
  };
  const Configuration configuration =
      read(with("  answer_timeout: 0.25\n  connect_timeout: 12\n  stall_timeout: 1.5\n"));
  EXPECT_EQ(configuration.answer_timeout, std::chrono::milliseconds(250));
  EXPECT_EQ(configuration.connect_timeout, std::chrono::seconds(12));
  EXPECT_EQ(configuration.stall_timeout, std::chrono::milliseconds(1500));
  const std::string text = effectiveConfiguration(configuration);
  EXPECT_EQ(effectiveConfiguration(read(text)), text);
  for (const char* key : {"answer_timeout", "connect_timeout", "stall_timeout"}) {
    for (const char* value : {"0.05", "61", "-1", "soon"}) {
      EXPECT_THAT(errorOf(with("  " + std::string(key) + ": " + value + "\n")),
                  AllOf(HasSubstr(std::string(":4: cameras.") + key), HasSubstr("a number from 0.1 to 60")));
    }
  }
}

TEST_F(ConfigurationFile, RejectsSameUrlForBothCameras) {
  EXPECT_THAT(errorOf("cameras:\n  left: {url: rtsp://a/1}\n  right: {url: rtsp://a/1}\nrig: rig.yaml\n"),
              AllOf(HasSubstr(":3: cameras.right.url"), HasSubstr("same URL")));
}

TEST_F(ConfigurationFile, ReadsV4l2Cameras) {
  const auto with = [](const std::string& left) {
    return "cameras:\n  left: {url: \"v4l2:/dev/video0\"" + left +
           "}\n  right: {url: \"v4l2:/dev/video2\"}\nrig: rig.yaml\n";
  };
  const Configuration configuration =
      read(with(", size: 1280x720, format: yuyv, exposure: 0.004, gain: 32, readout: -0.03"));
  EXPECT_TRUE(configuration.left.isV4l2());
  EXPECT_EQ(configuration.left.device(), "/dev/video0");
  EXPECT_EQ(configuration.left.size, cv::Size(1280, 720));
  EXPECT_EQ(configuration.left.format, capture::PixelFormat::yuyv);
  EXPECT_EQ(configuration.left.exposure, 0.004);
  EXPECT_EQ(configuration.left.gain, 32);
  EXPECT_EQ(configuration.left.readout, -0.03);
  EXPECT_EQ(withConfiguredReadouts({}, configuration).left.readout, -0.03);
  EXPECT_EQ(withConfiguredReadouts({}, configuration).right.readout, std::nullopt);
  EXPECT_TRUE(configuration.right.size.empty());
  const std::string text = effectiveConfiguration(configuration);
  EXPECT_EQ(effectiveConfiguration(read(text)), text);

  EXPECT_THAT(errorOf(with(", format: rgb")), HasSubstr("one of grey, nv12, yuyv, mjpeg"));
  EXPECT_THAT(errorOf(with(", size: 1280")), HasSubstr("1280x720"));
  EXPECT_THAT(errorOf(with(", readout: 32")), HasSubstr("cameras.left.readout"));
  EXPECT_THAT(errorOf(with(", exposure: 4")), HasSubstr("cameras.left.exposure"));
  EXPECT_THAT(errorOf(with(", username: admin")), HasSubstr("only an IP camera has this key"));
  EXPECT_THAT(errorOf("cameras:\n  left: {url: rtsp://a/1, gain: 3}\n  right: {url: rtsp://a/2}\nrig: r\n"),
              AllOf(HasSubstr(":2: cameras.left.gain"), HasSubstr("only a V4L2 camera has this key")));
  EXPECT_THAT(errorOf("cameras: {left: {url: \"v4l2:video0\"}, right: {url: rtsp://a/2}}\nrig: r\n"),
              HasSubstr("v4l2:/dev/video0"));
}

TEST_F(ConfigurationFile, IsWrittenAndReadBackUnchanged) {
  const Configuration configuration =
      read(std::string(kMinimal) +
           "tables: t.bin\nodometry: {features: 777, seed: 5, threads: 1, maximum_offset: 0.15}\n"
           "recording: {directory: rec, maximum_age: 2.5, keep_free: 0.5}\nlogging: {level: warning}\n");
  const std::string text = effectiveConfiguration(configuration);
  EXPECT_EQ(effectiveConfiguration(read(text)), text);
  EXPECT_THAT(text, AllOf(HasSubstr("features: 777"), HasSubstr("level: warning"),
                          HasSubstr("maximum_age: 2.5"), HasSubstr("maximum_offset: 0.15")));
  EXPECT_EQ(configuration.odometry.validity.maximum_offset, 0.15);
  EXPECT_EQ(configuration.recording_quota.maximum_age, std::chrono::hours(60));
  EXPECT_EQ(configuration.recording_quota.maximum_bytes, 20'000'000'000U);
  EXPECT_EQ(configuration.recording_quota.keep_free_bytes, 500'000'000U);
}

TEST_F(ConfigurationFile, ReadsEachListedKey) {
  // A map as the value of a key is an error that names the key, which shows that the key is read.
  for (const std::string& key : configurationKeys()) {
    YAML::Node document = YAML::LoadFile(kShipped.string());
    YAML::Node node;
    node.reset(document);
    std::istringstream parts(key);
    std::string part;
    while (std::getline(parts, part, '.')) {
      const YAML::Node next = node[part];
      node.reset(next);
    }
    if (node.IsDefined() && node.IsMap()) continue;  // a section
    node = YAML::Load("{nonsense: 1}");
    std::string dumped = YAML::Dump(document);
    EXPECT_THAT(errorOf(dumped), HasSubstr(key)) << dumped;
  }
}

}  // namespace
}  // namespace cartvo::daemon
