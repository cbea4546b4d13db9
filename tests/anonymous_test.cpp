#include <cstdlib>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include <dcmtk/config/osconfig.h>
#include <dcmtk/dcmdata/dctk.h>
#include <gtest/gtest.h>

#include "osteomill/base/temporary_folder.h"

namespace osteomill {
namespace {

namespace fs = std::filesystem;

constexpr int kSize = 20;

// The DICOM attributes that identify a patient.
const std::vector<std::pair<DcmTagKey, std::string>> kPatient{
    {DCM_PatientName, "Zzyzx^Quilla"},          {DCM_PatientID, "QX-7719302"},
    {DCM_PatientBirthDate, "19510203"},         {DCM_OtherPatientNames, "Zzyzx"},
    {DCM_PatientAddress, "Zzyzx Road 7719302"}, {DCM_ReferringPhysicianName, "Zzyzx^Doctor"}};
const std::vector<std::string> kSecrets{"Zzyzx", "Quilla", "7719302", "19510203"};

// Writes slice k of a ball of bone.
void write_slice(const fs::path& file, int k, const std::string& spacing = "0.5\\0.5") {
  DcmFileFormat dicom;
  DcmDataset& data = *dicom.getDataset();
  const std::string number = std::to_string(k);
  const auto set = [&](const DcmTagKey& tag, const std::string& text) {
    ASSERT_TRUE(data.putAndInsertString(tag, text.c_str()).good());
  };
  for (const auto& [tag, text] : kPatient) set(tag, text);
  set(DCM_SOPClassUID, UID_CTImageStorage);
  set(DCM_SOPInstanceUID, "1.2.3." + number);
  set(DCM_SeriesInstanceUID, "1.2.3");
  set(DCM_SeriesDescription, "ball");
  set(DCM_Modality, "CT");
  set(DCM_ImagePositionPatient, "0\\0\\" + std::to_string(0.5 * k));
  set(DCM_ImageOrientationPatient, "1\\0\\0\\0\\1\\0");
  set(DCM_PixelSpacing, spacing);
  set(DCM_PhotometricInterpretation, "MONOCHROME2");
  for (const auto& [tag, value] : {std::pair{DCM_Columns, kSize},
                                   {DCM_Rows, kSize},
                                   {DCM_SamplesPerPixel, 1},
                                   {DCM_BitsAllocated, 16},
                                   {DCM_BitsStored, 16},
                                   {DCM_HighBit, 15},
                                   {DCM_PixelRepresentation, 1}})
    data.putAndInsertUint16(tag, static_cast<Uint16>(value));
  std::vector<Uint16> pixels;
  for (int n = 0; n < kSize * kSize; ++n) {
    const int i = n % kSize - kSize / 2, j = n / kSize - kSize / 2, h = k - kSize / 2;
    pixels.push_back(i * i + j * j + h * h < 49 ? 1000 : 0);
  }
  data.putAndInsertUint16Array(DCM_PixelData, pixels.data(), pixels.size());
  ASSERT_TRUE(dicom.saveFile(file.c_str(), EXS_LittleEndianExplicit).good());
}

class Anonymous : public ::testing::Test {
 protected:
  void SetUp() override {
    fs::create_directories(folder_ / "scan");
    fs::create_directories(folder_ / "out");
    for (int k = 0; k < kSize; ++k) write_slice(folder_ / "scan" / ("slice" + std::to_string(k)), k);
  }

  // Writes outputs and messages into `out`.
  int run(const std::string& arguments) const {
    const std::string line =
        "cd '" + (folder_ / "out").string() + "' && " OSTEOMILL_PROGRAM " " + arguments + " >> said.txt 2>&1";
    return std::system(line.c_str()) == 0 ? 0 : 1;
  }

  void expect_no_name() const {
    int files = 0;
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder_ / "out")) {
      if (!entry.is_regular_file()) continue;
      ++files;
      std::ifstream in(entry.path(), std::ios::binary);
      const std::string bytes((std::istreambuf_iterator<char>(in)), {});
      for (const std::string& secret : kSecrets)
        EXPECT_EQ(bytes.find(secret), std::string::npos) << secret << " in " << entry.path();
    }
    EXPECT_GE(files, 1);
  }

  const TemporaryFolder folder_;
};

TEST_F(Anonymous, OutputFilesContainNoPatientData) {
  EXPECT_EQ(run("info ../scan"), 0);
  EXPECT_EQ(run("info ../scan --json"), 0);
  EXPECT_EQ(run("save ../scan --out a.nrrd"), 0);
  EXPECT_EQ(run("mesh ../scan --out a.ply"), 0);
  EXPECT_EQ(
      run("live ../scan --quiet --seconds 0.3 --algorithm line-proxy --burr-radius 1 --shaft-radius 0.5 "
          "--record a.h5"),
      0);
  EXPECT_EQ(run("report a.h5 --out report"), 0);
  expect_no_name();
}

TEST_F(Anonymous, MessagesAboutInvalidSeriesContainNoPatientData) {
  EXPECT_EQ(run("info ../scan --series 9"), 1);
  for (const char* spacing : {"0\\0", "0.7\\0.7", "Zzyzx"}) {
    write_slice(folder_ / "scan" / "slice3", 3, spacing);
    EXPECT_EQ(run("info ../scan"), 1);
  }
  fs::resize_file(folder_ / "scan" / "slice3", 500);
  EXPECT_EQ(run("info ../scan"), 1);
  expect_no_name();
}

}  // namespace
}  // namespace osteomill
