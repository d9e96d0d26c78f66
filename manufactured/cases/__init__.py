"""The cases, one file per exact solution; ``manufactured.catalogue`` lists them."""
