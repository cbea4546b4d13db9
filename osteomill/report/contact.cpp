#include "osteomill/report/contact.h"

#include <fmt/format.h>

namespace osteomill {

namespace {

constexpr double kFelt_N = 0.02;
constexpr double kFelt_Nmm = 0.2;
constexpr double kLost_s = 1;

}  // namespace

Contact contact_of(const TickRecord& record) {
  Contact contact;
  contact.burr = record.burr_force_W_N.norm() >= kFelt_N;
  contact.shaft = (record.wrench.torque_Nmm - record.cutting_torque_W_Nmm).norm() >= kFelt_Nmm;
  contact.force = contact.burr || record.wrench.force_N.norm() >= kFelt_N;
  contact.torque = record.wrench.torque_Nmm.norm() >= kFelt_Nmm;
  return contact;
}

ContactShares contact_shares(std::span<const TickRecord> records) {
  ContactShares shares;
  if (records.empty()) return shares;
  const double began_s = records.front().time_s;
  double last_s = began_s;
  for (const TickRecord& record : records) {
    const Contact contact = contact_of(record);
    shares.any += contact.any();
    shares.burr += contact.burr;
    shares.shaft += contact.shaft;
    shares.force += contact.force;
    shares.torque += contact.torque;
    if (contact.any()) last_s = record.time_s;
  }
  if (shares.any == 0 || records.back().time_s - last_s >= kLost_s) shares.lost_after_s = last_s - began_s;
  shares.lost_while_milling = shares.any > 0 && shares.is_lost() && records.back().spindle_on;
  for (double* share : {&shares.any, &shares.burr, &shares.shaft, &shares.force, &shares.torque}) {
    *share /= static_cast<double>(records.size());
  }
  return shares;
}

std::string contact_words(const ContactShares& contact) {
  const auto share_of_time = [](double share) {
    return fmt::format("for {:.0f} % of the time", 100 * share);
  };
  if (contact.any == 0) return contact.lost_while_milling ? "lost while milling" : "never touched";
  if (contact.is_lost() && contact.lost_while_milling)
    return fmt::format("lost while milling, after {:.1f} s", contact.lost_after_s);
  if (contact.is_lost()) return fmt::format("lost contact after {:.1f} s", contact.lost_after_s);
  if (!is_enough_contact(contact.any)) return "touched " + share_of_time(contact.any);
  if (!is_enough_contact(contact.shaft)) return "the shaft touched " + share_of_time(contact.shaft);
  return "felt a force " + share_of_time(contact.force);
}

}  // namespace osteomill
