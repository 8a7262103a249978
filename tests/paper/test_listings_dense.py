"""The paper's listings 1 and 2 run as printed, and what they compute is what its definitions say."""

from __future__ import annotations

import rtamt


def test_listing_1_evaluates_offline():
    spec = rtamt.StlDenseTimeOfflineSpecification()
    spec.declare_var("req", "float")
    spec.declare_var("gnt", "float")
    spec.spec = "G((req>=3)->(F[0,5](gnt>=3)))"
    spec.parse()

    req = [[0.0, 0.0], [2.0, 6.0], [4.0, 0.0], [10.0, 0.0]]
    gnt = [[0.0, 0.0], [6.0, 6.0], [8.0, 0.0], [10.0, 0.0]]

    rob = spec.evaluate(["req", req], ["gnt", gnt])
    assert rob == [[0.0, 3.0], [10.0, 3.0]]


def listing_2(pastified):
    spec = rtamt.StlDenseTimeOnlineSpecification()
    spec.declare_var("req", "float")
    spec.declare_var("gnt", "float")
    if pastified:
        spec.spec = "G[0,10]((req>=3)->(F[0,5](gnt>=3)))"
        spec.parse()
        spec.pastify()
    else:
        spec.spec = "H[0,10]((O[5,5](req>=3))->(O[0,5](gnt>=3)))"
        spec.parse()

    req_0 = [[0.0, 0.0], [2.0, 6.0]]
    gnt_0 = [[0.0, 0.0], [5.0, 6.0]]
    req_1 = [[4.0, 0.0], [10.0, 0.0]]
    gnt_1 = [[8.0, 0.0], [10.0, 0.0]]

    first = spec.update(["req", req_0], ["gnt", gnt_0])
    second = spec.update(["req", req_1], ["gnt", gnt_1])
    return first, second


def test_listing_2_updates_online():
    # Before t = 5 no request can have been made 5 seconds ago, and -inf implies anything.
    first, second = listing_2(pastified=False)
    assert first == [[0.0, float("inf")], [2.0, float("inf")]]
    assert second == [[5.0, 3.0], [10.0, 3.0]]


def test_listing_2_with_pastify_inserted_as_the_text_says():
    # The horizon of the requirement is 15, later than the last sample; before it, only windows
    # that have begun count.
    first, second = listing_2(pastified=True)
    assert [time for time, _ in first] == [0.0, 2.0]
    assert second[-1] == [10.0, 3.0]
