"""What is written of a graded class: pages, tables, and what Gradescope reads."""
