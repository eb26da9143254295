"""Laws that many columns assert and that cost seconds each: `make test` takes every second or third case of them.

`pytest --all-cases` takes all, and `CI_SUITE=all .ci/run` does. Chosen from the processor time of each test: what
stands here took 390 s of 1,400 s of the suite.
"""

EVERY = {
    "certify/test_beam_certificates.py::test_a_certificate_is_accepted_as_it_was_written": 2,
    "certify/test_beam_ranges.py::test_each_value_of_the_range_has_its_load_in_its_piece": 3,
    "certify/test_beam_stability.py::test_the_first_loss_of_stability_of_the_beam_itself_is_proven": 2,
    "certify/test_exact_system.py::test_an_enclosure_is_where_independent_codes_find_the_load": 3,
    "certify/test_exact_system.py::test_functions_of_x_are_what_they_are": 2,
    "certify/test_floquet.py::test_the_enclosure_is_narrow_and_holds_the_multipliers": 3,
    "certify/test_general_certificates.py::test_a_true_certificate_is_accepted_and_says_what_it_proves": 3,
    "certify/test_general_certificates.py::test_the_verifier_s_matrices_have_the_kernel_s_eigenvalues": 3,
    "certify/test_general_certificates.py::test_forgeries_are_refused": 3,
    "certify/test_motions_apart.py::test_frequencies_pass_and_the_first_loss_is_that_of_a_dense_scan": 3,
    "certify/test_verifier.py::test_forgeries_are_refused_and_true_certificates_accepted": 3,
    "derive/test_integrals.py::test_closed_forms_against_quadrature": 3,
    "derive/test_kernel.py::test_at_most_forty_operations_an_entry": 3,
    "derive/test_language.py::test_equations_and_conditions_are_the_weak_form": 3,
    "derive/test_language.py::test_forms_are_the_weak_form": 3,
    "derive/test_language.py::test_the_weak_form_is_hamilton_s_principle_as_stated": 3,
    "derive/test_languages.py::test_kernels_keep_the_bounds_of_the_numpy_ones": 3,
    "derive/test_legendre.py::test_columns_are_exact_and_accurate": 3,
    "derive/test_segments.py::test_matrices_are_the_integrals": 2,
    "derive/test_statement.py::test_sense_is_not_refused": 2,
    "derive/test_verify.py::test_every_constant_table_is_verified": 2,
    "derive/test_verify.py::test_functions_of_a_parameter_are_verified_at_all_its_sizes": 3,
    "derive/test_verify.py::test_sums_that_nearly_cancel_are_no_errors": 3,
    "derive/test_verify.py::test_tampered_kernels_are_refused": 2,
    "explorer/test_page.py::test_first_losses_and_touches_are_those_of_the_runtime": 2,
    "runtime/test_any_column.py::test_a_column_as_it_is_stated_has_its_critical_load": 2,
    "runtime/test_exact_response.py::test_forced_motion_is_that_of_an_integrator": 3,
    "runtime/test_general.py::test_random_systems_lose_stability_where_a_scan_says": 3,
    "runtime/test_gradient.py::test_gradients_are_differences_of_loads": 2,
    "runtime/test_random_columns.py::test_random_columns_agree_with_elements": 2,
    "runtime/test_spectra.py::test_branches_do_not_depend_on_the_loads_between": 2,
    "test_gallery.py::test_a_boundary_that_starts_there_agrees": 3,
    "test_gallery.py::test_a_proof_agrees_or_says_that_there_is_none": 3,
    "test_gallery.py::test_the_first_loss_among_all_proven_crossings_agrees": 3,
    "test_references.py::test_each_value_by_elements_then_by_taylor_steps": 3,
}
