#include <minizip/zip.h>

#include "tests/support/folder_test.h"

namespace osteomill {
namespace {

namespace fs = std::filesystem;
using testing_support::contains;

const std::string kNrrd =
    "NRRD0004\ntype: short\ndimension: 3\nsizes: 2 2 2\nspacings: 1 1 1\nencoding: ascii\n\n1 2 3 4 5 6 7 "
    "8\n";

class ZipArchive : public testing_support::FolderTest {
 protected:
  struct Member {
    std::string name;
    std::string bytes;
  };

  fs::path write_zip(const std::vector<Member>& members) const {
    const fs::path path = folder_ / "scan.zip";
    zipFile const zip = zipOpen64(path.c_str(), APPEND_STATUS_CREATE);
    for (const Member& member : members) {
      const zip_fileinfo info{};
      zipOpenNewFileInZip64(zip, member.name.c_str(), &info, nullptr, 0, nullptr, 0, nullptr, 8, 9, 1);
      zipWriteInFileInZip(zip, member.bytes.data(), static_cast<unsigned>(member.bytes.size()));
      zipCloseFileInZip(zip);
    }
    zipClose(zip, nullptr);
    return path;
  }
};

TEST_F(ZipArchive, ReadsItsOnlyScanAndRefusesNoneOrSeveral) {
  const Scan scan =
      read_scan(write_zip({{"case/", ""}, {"case\\a.nrrd", kNrrd}, {"__MACOSX/case/._a.nrrd", "x"}}));
  EXPECT_EQ(scan.grid[(VoxelIndex{1, 1, 1})], 8);
  EXPECT_EQ(scan.name, (folder_ / "scan.zip").string());
  // Errors name the file within the archive.
  EXPECT_TRUE(contains(refusal(write_zip({{"case/a.nrrd", kNrrd.substr(0, kNrrd.size() - 4)}})),
                       (folder_ / "scan.zip/case/a.nrrd: is cut short").string()));
  EXPECT_TRUE(contains(refusal(write_zip({{"a.nrrd", kNrrd}, {"b.nrrd", kNrrd}})), "holds 2 scans"));
  EXPECT_TRUE(contains(refusal(write_zip({{"readme", "hello"}})), "scan.zip: holds no scan"));
}

TEST_F(ZipArchive, RefusesMemberPathsThatLeadOutOfTheArchive) {
  for (const char* name : {"../a.nrrd", "case/../../a.nrrd", "/tmp/osteomill_a.nrrd", "..\\a.nrrd"}) {
    EXPECT_TRUE(contains(refusal(write_zip({{name, kNrrd}})), "leads out of the archive")) << name;
  }
}

TEST_F(ZipArchive, RefusesToUnpackMoreThanTheMemoryLimit) {
  const fs::path bomb =
      write_zip({{"a", std::string(10'000'000, '\0')}, {"b", std::string(10'000'000, '\0')}});
  EXPECT_LT(fs::file_size(bomb), 100'000U);
  try {
    read_scan(bomb, {.series = "", .max_memory_bytes = 15'000'000});
    FAIL();
  } catch (const InputError& error) {
    EXPECT_TRUE(contains(error.what(), "scan.zip: unpacks to more than the limit of 0.015 GB"))
        << error.what();
  }
}

TEST_F(ZipArchive, RefusesATruncatedOrCorruptedArchive) {
  const fs::path path = write_zip({{"a.nrrd", kNrrd}});
  std::ifstream in(path, std::ios::binary);
  const std::string bytes((std::istreambuf_iterator<char>(in)), {});
  // The last field, the length of a comment, does not matter.
  for (std::size_t length = 1; length < bytes.size() - 10; ++length) {
    EXPECT_FALSE(refusal(write("cut.zip", bytes.substr(0, length))).empty()) << length;
  }
  std::string other = bytes;
  other[60] = static_cast<char>(other[60] ^ 0x10);
  EXPECT_TRUE(contains(refusal(write("damaged.zip", other)), "damaged"));
}

}  // namespace
}  // namespace osteomill
