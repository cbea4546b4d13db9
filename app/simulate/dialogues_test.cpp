#include "app/simulate/dialogues.h"

#include <algorithm>

#include <gtest/gtest.h>

namespace osteomill::app {
namespace {

// Returns every dialogue of the window, with how it is ended: by the button of this number.
std::vector<Dialogue> dialogues_of_the_window(int& acted) {
  const auto act = [&acted] { ++acted; };
  const auto never = [] { return false; };
  DialogueQueue complaints;
  complaints.add_error("no-such-scan: cannot be read");
  return {*complaints.current(),
          unsaved_question("Closing the window", never, act, act, act),
          unsaved_question("Resetting the bone", never, act, act, act),
          report_question(act, act),
          leftover_question({}, act, act, act),
          {"Save the milled bone?", "Saving ...", {}, [] { return true; }, act}};
}

TEST(DialogueQueue, ShowsTwoDialoguesInTurnAndRunsEachAnswer) {
  int acted = 0;
  const std::vector<Dialogue> all = dialogues_of_the_window(acted);
  for (const Dialogue& first : all) {
    for (const Dialogue& second : all) {
      if (first.text == second.text) continue;
      for (std::size_t choice = 0; choice < 3; ++choice) {
        DialogueQueue queue;
        queue.add(first);
        queue.add(second);
        for (const Dialogue* expected : {&first, &second}) {
          ASSERT_NE(queue.current(), nullptr);
          EXPECT_EQ(queue.current()->text, expected->text);
          const auto buttons = expected->choices.size();
          const bool acts =
              buttons == 0 || expected->choices[std::min(choice, buttons - 1)].action != nullptr;
          const int before = acted;
          if (buttons > 0) queue.choose(std::min(choice, buttons - 1));
          queue.proceed();
          EXPECT_EQ(acted, before + (acts ? 1 : 0));
        }
        EXPECT_EQ(queue.current(), nullptr);
      }
    }
  }
}

TEST(DialogueQueue, KeepsADialogueUntilItIsAnswered) {
  DialogueQueue queue;
  queue.add_error("no-such-scan: cannot be read");
  queue.proceed();
  EXPECT_EQ(queue.errors(), std::vector<std::string>{"no-such-scan: cannot be read"});
  queue.choose(0);
  queue.proceed();
  EXPECT_TRUE(queue.errors().empty());
}

TEST(DialogueQueue, ShowsARepeatedErrorOnce) {
  DialogueQueue queue;
  queue.add_error("a");
  queue.add_error("b");
  queue.add_error("a");
  EXPECT_EQ(queue.errors(), (std::vector<std::string>{"a", "b"}));
}

TEST(DialogueQueue, ProceedsWithoutAskingOnceAQuestionIsSettled) {
  bool saved = false;
  int went_on = 0;
  DialogueQueue queue;
  const auto ask = [&](const char* what) {
    queue.add(unsaved_question(
        what, [&] { return saved; }, [&] { saved = true; }, [&] { ++went_on; }, {}));
  };
  ask("Resetting the bone");
  ask("Closing the window");
  queue.proceed();
  EXPECT_EQ(went_on, 0);
  queue.choose(0);
  queue.proceed();
  queue.proceed();
  EXPECT_EQ(queue.current(), nullptr);
  EXPECT_EQ(went_on, 1);
}

// A dialogue added by an action comes after those already waiting.
TEST(DialogueQueue, AppendsADialogueThatAnActionAdds) {
  DialogueQueue queue;
  queue.add(report_question([&] { queue.add_error("disk full"); }, {}));
  queue.add_error("before");
  queue.choose(0);
  queue.proceed();
  EXPECT_EQ(queue.errors(), (std::vector<std::string>{"before", "disk full"}));
}

}  // namespace
}  // namespace osteomill::app
