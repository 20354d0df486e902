// Documents of simulated cameras.
#include <regex>

#include "support/camera/isapi_server.hpp"

namespace cartvo::test {
namespace {

constexpr const char* kImage = R"(
<id>1</id><enabled>true</enabled><videoInputID>1</videoInputID>
<ImageFlip><enabled>false</enabled></ImageFlip>
<WDR><mode>open</mode><WDRLevel>50</WDRLevel></WDR>
<BLC><enabled>false</enabled></BLC>
<NoiseReduce><mode>general</mode><GeneralMode><generalLevel>50</generalLevel></GeneralMode></NoiseReduce>
<IrcutFilter><IrcutFilterType>auto</IrcutFilterType><nightToDayFilterLevel>4</nightToDayFilterLevel></IrcutFilter>
<Exposure><ExposureType>auto</ExposureType></Exposure>
<Sharpness><SharpnessLevel>50</SharpnessLevel></Sharpness>
<powerLineFrequency><powerLineFrequencyMode>50hz</powerLineFrequencyMode></powerLineFrequency>
<Color><brightnessLevel>50</brightnessLevel></Color>
<Shutter><ShutterLevel>1/25</ShutterLevel></Shutter>
<DSS><enabled>true</enabled><DSSLevel>*2</DSSLevel></DSS>
<Dehaze><DehazeMode>auto</DehazeMode></Dehaze>
<EIS><enabled>true</enabled></EIS>
<LensDistortionCorrection><enabled>true</enabled></LensDistortionCorrection>
<vendorExtension><secretSauce level="7">keep me</secretSauce></vendorExtension>
)";

constexpr const char* kImageCapabilities = R"(
<WDR><mode opt="open,close,auto">open</mode></WDR>
<IrcutFilter><IrcutFilterType opt="auto,day,night,schedule">auto</IrcutFilterType></IrcutFilter>
<Sharpness><SharpnessLevel min="0" max="100">50</SharpnessLevel></Sharpness>
<Dehaze><DehazeMode opt="open,close,auto">auto</DehazeMode></Dehaze>
<powerLineFrequency><powerLineFrequencyMode opt="50hz,60hz">50hz</powerLineFrequencyMode></powerLineFrequency>
<Shutter><ShutterLevel opt="1/3,1/25,1/50,1/100,1/250,1/500,1/1000,1/100000">1/25</ShutterLevel></Shutter>
)";

constexpr const char* kStream = R"(
<id>101</id><channelName>Camera 01</channelName><enabled>true</enabled>
<Transport><maxPacketSize>1000</maxPacketSize></Transport>
<Video><enabled>true</enabled><videoCodecType>H.265</videoCodecType><videoScanType>progressive</videoScanType>
<videoResolutionWidth>1280</videoResolutionWidth><videoResolutionHeight>720</videoResolutionHeight>
<videoQualityControlType>VBR</videoQualityControlType><constantBitRate>2048</constantBitRate><fixedQuality>60</fixedQuality>
<vbrUpperCap>2048</vbrUpperCap><maxFrameRate>2500</maxFrameRate><keyFrameInterval>2000</keyFrameInterval>
<GovLength>50</GovLength><H264Profile>High</H264Profile><SVC><enabled>true</enabled></SVC>
<SmartCodec><enabled>true</enabled></SmartCodec></Video>
<Audio><enabled>true</enabled><audioInputChannelID>1</audioInputChannelID></Audio>
)";

constexpr const char* kStreamCapabilities = R"(
<Video><videoCodecType opt="H.264,H.265">H.265</videoCodecType>
<videoQualityControlType opt="CBR,VBR">VBR</videoQualityControlType>
<constantBitRate min="32" max="16384">2048</constantBitRate>
<maxFrameRate opt="600,1200,1500,1800,2000,2500,3000">2500</maxFrameRate>
<GovLength min="1" max="400">50</GovLength><H264Profile opt="Baseline,Main,High">High</H264Profile></Video>
)";

constexpr const char* kOverlays = R"(
<fontSize>adaptive</fontSize>
<TextOverlayList size="2"><TextOverlay><id>1</id><enabled>true</enabled><displayText>cart</displayText></TextOverlay>
<TextOverlay><id>2</id><enabled>false</enabled><displayText/></TextOverlay></TextOverlayList>
<DateTimeOverlay><enabled>true</enabled><positionX>0</positionX></DateTimeOverlay>
<channelNameOverlay><enabled>true</enabled></channelNameOverlay>
)";

constexpr const char* kTime =
    "<timeMode>manual</timeMode><localTime>2026-01-01T00:00:00+00:00</localTime><timeZone>CST-8:00:00</"
    "timeZone>";

constexpr const char* kTimeServers = R"(
<NTPServer><id>1</id><addressingFormatType>hostname</addressingFormatType><hostName>time.windows.com</hostName>
<portNo>123</portNo><synchronizeInterval>1440</synchronizeInterval></NTPServer>
)";

constexpr const char* kDevice = R"(
<deviceName>IP CAMERA</deviceName><deviceID>1</deviceID><model>DS-2CD2143G2-I</model>
<serialNumber>DS-2CD2143G2-I20230101AAWRC00000001</serialNumber><macAddress>44:19:b6:00:00:01</macAddress>
<firmwareVersion>V5.7.3</firmwareVersion><firmwareReleasedDate>build 220112</firmwareReleasedDate>
<deviceType>IPCamera</deviceType>
)";

}  // namespace

IsapiDocuments factoryDocuments(const std::string& root_attributes) {
  const auto document = [&](const std::string& root, const std::string& content) {
    return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<" + root + " " + root_attributes + ">" + content +
           "</" + root + ">\n";
  };
  return {{"/ISAPI/System/deviceInfo", document("DeviceInfo", kDevice)},
          {"/ISAPI/Streaming/channels/101", document("StreamingChannel", kStream)},
          {"/ISAPI/Streaming/channels/101/capabilities", document("StreamingChannel", kStreamCapabilities)},
          {"/ISAPI/Image/channels/1", document("ImageChannel", kImage)},
          {"/ISAPI/Image/channels/1/capabilities", document("ImageChannel", kImageCapabilities)},
          {"/ISAPI/System/Video/inputs/channels/1/overlays", document("VideoOverlay", kOverlays)},
          {"/ISAPI/System/time", document("Time", kTime)},
          {"/ISAPI/System/time/ntpServers", document("NTPServerList", kTimeServers)}};
}

IsapiDocuments oldFirmwareDocuments() {
  IsapiDocuments documents = factoryDocuments("version=\"1.0\" xmlns:p=\"urn:psialliance-org\"");
  documents.erase("/ISAPI/Image/channels/1/capabilities");
  documents.erase("/ISAPI/Streaming/channels/101/capabilities");
  const std::regex newer("<(EIS|LensDistortionCorrection|Dehaze|SmartCodec)>.*?</\\1>");
  for (auto& [path, text] : documents) {
    text = std::regex_replace(text, newer, "");
    text = std::regex_replace(text, std::regex("<mode>open</mode>"), "<enabled>true</enabled>");
    text = std::regex_replace(text, std::regex(">([^<>\\s][^<>]*)<"), "> $1 \r\n<");
    text = std::regex_replace(text, std::regex("<(/?)([A-Za-z])"), "<$1p:$2");
  }
  return documents;
}

IsapiDocuments withSerialNumber(IsapiDocuments documents, const std::string& serial_number) {
  std::string& device = documents.at("/ISAPI/System/deviceInfo");
  device = std::regex_replace(device, std::regex("(<([a-z]+:)?serialNumber>)[^<]*"), "$1" + serial_number);
  return documents;
}

}  // namespace cartvo::test
