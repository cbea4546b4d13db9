#include "app/simulate/folder_listing.h"

#include <fstream>

#include <gtest/gtest.h>

#include "tests/support/folder_test.h"

namespace osteomill::app {
namespace {

using Entries = std::vector<FolderListing::Entry>;

class ListFolder : public testing_support::FolderTest {
 protected:
  void touch(const std::string& name, const std::string& text = "") const {
    std::ofstream(folder_ / name) << text;
  }
};

TEST_F(ListFolder, ListsFoldersFirstAndOnlyFilesThatCanBeOpened) {
  std::filesystem::create_directory(folder_ / "b");
  std::filesystem::create_directory(folder_ / ".git");
  const std::string dicom = std::string(128, '\0') + "DICM";
  for (const char* name : {"a.nrrd", "c.nii.gz", "d.h5", "e.txt", ".f.nrrd", "g.png", "h.ZIP", "i.toml"})
    touch(name);
  touch("IM0001", dicom);
  touch("1.2.840.113", dicom);
  touch("README", "text");
  touch("x.raw", dicom);
  const FolderListing listing = list_folder(folder_, false);
  EXPECT_EQ(listing.entries, (Entries{{"b", true},
                                      {"1.2.840.113"},
                                      {"IM0001"},
                                      {"a.nrrd"},
                                      {"c.nii.gz"},
                                      {"d.h5"},
                                      {"h.ZIP"},
                                      {"i.toml"}}));
  EXPECT_EQ(listing.complaint, "");
  EXPECT_FALSE(listing.has_more);
}

TEST_F(ListFolder, ReportsAMissingFolderInOneLine) {
  const FolderListing listing = list_folder(folder_ / "gone", false);
  EXPECT_EQ(listing.complaint, (folder_ / "gone").string() + ": cannot be read: No such file or directory");
}

TEST_F(ListFolder, ReportsWhetherThePathIsAFile) {
  touch("a.nrrd");
  EXPECT_TRUE(list_folder(folder_ / "a.nrrd", false).is_file);
  EXPECT_EQ(list_folder(folder_ / "a.nrrd", false).complaint, "");
  EXPECT_FALSE(list_folder(folder_, false).is_file);
}

TEST_F(ListFolder, EndsAtTheEntryLimitOrWhenStopped) {
  for (std::size_t n = 0; n <= kMaxListed; ++n) touch(std::to_string(n) + ".mha");
  const FolderListing listing = list_folder(folder_, false);
  EXPECT_EQ(listing.entries.size(), kMaxListed);
  EXPECT_TRUE(listing.has_more);
  EXPECT_TRUE(list_folder(folder_, true).entries.empty());
}

}  // namespace
}  // namespace osteomill::app
