#!/usr/bin/env python3
"""passed_tests_test.py SOURCE BUILD: a test that has passed runs again if anything that it sees has changed."""

import json
import os
import pathlib
import sys
import tempfile
import unittest
import unittest.mock

source, build = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
sys.path.insert(0, str(source / "cmake"))
import passed_tests  # noqa: E402
from affected_tests_test import EXPECTED  # noqa: E402

RESULTS = """<testsuite>
  <testcase name="passes" status="run"/>
  <testcase name="fails" status="fail"><failure message=""/></testcase>
  <testcase name="is_skipped" status="notrun"><skipped message="SKIP_RETURN_CODE=77"/></testcase>
  <testcase name="has_no_key" status="run"/>
</testsuite>
"""


def keys_of_programs(keys):
    """The key of each test, by its name and the name of its program."""
    return {(test.name, os.path.basename(test.program)): keys.key(test) for test in keys.tests}


class KeysTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.keys = passed_tests.Keys(build)
        cls.keys.built = float("inf")  # sources may be edited meanwhile
        cls.before = keys_of_programs(cls.keys)
        cls.programs = {program for (_, program), key in cls.before.items() if key}

    def changed_with(self, path):
        """The programs of tests whose keys are others if the content of a file is another."""
        real = passed_tests.content_of

        def content_of(asked):
            return ("another", 0) if asked == path else real(asked)

        with unittest.mock.patch.object(passed_tests, "content_of", content_of):
            after = keys_of_programs(self.keys)
        return {program for (name, program), key in self.before.items() if key and after[name, program] != key}

    def test_change_with_the_files_that_a_test_sees(self):
        for path, seen_by, not_seen_by in EXPECTED:
            with self.subTest(path):
                changed = self.changed_with(path)
                self.assertEqual(set(), (seen_by & self.programs) - changed)
                self.assertEqual(set(), not_seen_by & changed)

    def test_change_all_with_a_file_of_cmake(self):
        self.assertEqual(self.programs, self.changed_with("CMakeLists.txt"))

    def test_do_not_change_with_scripts_that_only_run_tests(self):
        for path in ("cmake/tidy.py", "Makefile", "README.md"):
            self.assertTrue((source / path).exists(), path)
            self.assertEqual(set(), self.changed_with(path))

    def test_change_with_the_machine_and_its_variables(self):
        with unittest.mock.patch.dict(os.environ, {"SURFCAST_DAMAGED_INPUTS": "7"}):
            self.assertNotEqual(passed_tests.machine(), self.keys.machine)
        with unittest.mock.patch.dict(os.environ, {"SURFCAST_CHECK_BASE": "7"}):
            self.assertEqual(passed_tests.machine(), self.keys.machine)

    def test_are_missing_where_versions_of_packages_are_not_known(self):
        with unittest.mock.patch.dict(os.environ, {"PATH": ""}):
            self.assertIsNone(passed_tests.machine())
        with unittest.mock.patch.object(self.keys, "machine", None):
            self.assertEqual({None}, set(keys_of_programs(self.keys).values()))

    def test_are_missing_where_a_script_reads_the_sources(self):
        self.assertIsNone(self.before["documented_headers_test", "documented_headers_test.py"])

    def test_are_missing_where_a_file_is_newer_than_the_build(self):
        with unittest.mock.patch.object(self.keys, "built", 0):
            self.assertEqual({None}, set(keys_of_programs(self.keys).values()))


class NotesTest(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.notes, self.build = pathlib.Path(temporary.name, "notes"), pathlib.Path(temporary.name)
        variables = unittest.mock.patch.dict(os.environ, {"SURFCAST_PASSED_TESTS": str(self.notes)})
        variables.start()
        self.addCleanup(variables.stop)
        names = ("passes", "fails", "is_skipped", "is_not_run")
        (self.build / "test_keys.json").write_text(json.dumps({name: "key_of_" + name for name in names}))
        (self.build / "results.xml").write_text(RESULTS)

    def test_are_of_the_tests_that_passed(self):
        passed_tests.record(self.build, self.build / "results.xml")
        self.assertEqual(["key_of_passes"], os.listdir(self.notes))

    def test_end_after_thirty_days_without_use(self):
        self.notes.mkdir()
        old = self.notes / "old"
        old.touch()
        os.utime(old, (0, 0))
        passed_tests.record(self.build, self.build / "results.xml")
        self.assertFalse(old.exists())


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
