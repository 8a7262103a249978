#include "program/fault.hpp"

#include "check.hpp"

#include <string>

using rtamt::Fault;

TEST(keeps_a_copy_of_a_sentence_and_cuts_a_long_one) {
    std::string sentence = "it broke";
    const Fault fault(sentence.c_str());
    sentence = "changed";
    CHECK(fault && fault.text() == "it broke");
    const std::string novel(1000, 'x');
    CHECK(Fault(novel.c_str()).text() == novel.substr(0, 256));
}

TEST(no_sentence_is_no_fault) {
    CHECK(!Fault() && !Fault(nullptr) && Fault().text().empty());
}
