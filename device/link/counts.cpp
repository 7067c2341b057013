// SPDX-License-Identifier: Apache-2.0
#include "device/link/counts.h"

namespace fasttree::device {

LinkCounts& LinkCounts::operator+=(const LinkCounts& other) {
  frames_sent += other.frames_sent;
  frames_received += other.frames_received;
  data_bytes_sent += other.data_bytes_sent;
  data_bytes_received += other.data_bytes_received;
  retransmitted += other.retransmitted;
  timeouts += other.timeouts;
  bad_length += other.bad_length;
  bad_checksum += other.bad_checksum;
  bad_type += other.bad_type;
  bad_content += other.bad_content;
  wrong_session += other.wrong_session;
  out_of_window += other.out_of_window;
  duplicates += other.duplicates;
  return *this;
}

}  // namespace fasttree::device
