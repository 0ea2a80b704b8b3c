// packed: for each source in turn its number of rows (negative: unchanged), then its columns.
const { packed } = cb_obj.data;
let at = 0;
sources.forEach((source, i) => {
  const rows = packed[at++];
  if (!(rows >= 0)) return;
  const data = {};
  for (const name of columns[i]) {
    data[name] = new Float64Array(packed.buffer, packed.byteOffset + 8 * at, rows);
    at += rows;
  }
  source.setv({ data }, { sync: false, check_eq: false });
});
