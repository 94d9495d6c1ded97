// Style sheets that scripts have in them are texts.
declare module "*.css" {
  const text: string;
  export default text;
}
