//! A film of integer sums, pixel filters, EXR and PNG files, image metrics.
